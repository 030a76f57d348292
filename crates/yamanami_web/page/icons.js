// The page's own icons: strokes on a field of 24 by 24.

const PATHS = {
  home: 'M4 11.5 12 4l8 7.5M6.5 10v9.5h11V10M10 19.5v-5h4v5',
  nearer: 'M12 5v14M5 12h14',
  farther: 'M5 12h14',
  turn: 'M19.5 12a7.5 7.5 0 1 1-2.3-5.4M17.5 2.5v4.4h-4.4',
  pan: 'M12 3v18M3 12h18M9.5 5.5 12 3l2.5 2.5M9.5 18.5 12 21l2.5-2.5M5.5 9.5 3 12l2.5 2.5M18.5 9.5 21 12l-2.5 2.5',
  fly: 'M3 12.5 21 4l-5.5 16-4-6.2zM11.5 13.8 21 4',
  map: 'M3.5 6.5 9 4l6 2.5L20.5 4v13.5L15 20l-6-2.5L3.5 20zM9 4v13.5M15 6.5V20',
  profile: 'M3.5 4v16h17M6 16l4-6 3.5 3.5L20 7',
  picture: 'M4 7.5h4L9.5 5h5L16 7.5h4v11.5H4zM12 16.2a3.2 3.2 0 1 0 0-6.4 3.2 3.2 0 0 0 0 6.4',
  full: 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5',
  help: 'M9 9.3a3 3 0 1 1 4.3 2.7c-.9.4-1.3 1-1.3 2M12 17.2v.3M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18',
  fold: 'M6 9.5 12 15l6-5.5',
  close: 'M6 6l12 12M18 6 6 18',
  undo: 'M8.5 5 4 9.5 8.5 14M4.5 9.5H14a5.5 5.5 0 0 1 0 11h-3',
  save: 'M12 4v11M7.5 11 12 15.5 16.5 11M4.5 19.5h15',
  file: 'M6 3.5h8l4.5 4.5v12.5H6zM14 3.5V8h4.5',
};

const SVG = 'http://www.w3.org/2000/svg';

/** An element of SVG with attributes. */
export function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

export function icon(name) {
  const attributes = { viewBox: '0 0 24 24', class: 'icon', 'aria-hidden': 'true', focusable: 'false' };
  return svg('svg', attributes, svg('path', { d: PATHS[name] }));
}
