// A plot of heights along a line, in SVG: axes with units, a cursor for pointer and keys.

import * as format from './format.js';
import { svg } from './icons.js';
import { t } from './i18n.js';

const MARGIN = { left: 58, right: 14, top: 10, bottom: 26 };

export class Plot {
  #box;
  #data = null;
  #corners = [];
  #moved;
  /** The sample under the cursor, or null. */
  cursor = null;

  /** `moved()` hears when the cursor moves. */
  constructor(box, moved) {
    this.#box = box;
    this.#moved = moved;
    new ResizeObserver(() => this.#draw()).observe(box);
    box.addEventListener('pointermove', (event) => this.#point(event.offsetX));
    box.addEventListener('pointerleave', () => this.#set(null));
    box.addEventListener('keydown', (event) => this.#key(event));
  }

  clear() {
    this.#data = null;
    this.cursor = null;
    this.#box.replaceChildren();
    this.#box.removeAttribute('aria-label');
  }

  show(data, corners, words) {
    this.#data = data;
    this.#corners = corners;
    if (this.cursor !== null) this.cursor = Math.min(this.cursor, data.distance_m.length - 1);
    this.#box.setAttribute('aria-label', words);
    this.#draw();
  }

  #frame() {
    const [width, height] = [Math.max(this.#box.clientWidth, 120), Math.max(this.#box.clientHeight, 80)];
    const heights = this.#data.height_m.filter((value) => value !== null);
    const least = heights.reduce((a, b) => Math.min(a, b), Infinity);
    const most = heights.reduce((a, b) => Math.max(a, b), -Infinity);
    const room = Math.max((most - least) * 0.08, 1e-3);
    const [low, high] = heights.length ? [least - room, most + room] : [0, 1];
    const end = this.#data.distance_m.at(-1) || 1;
    const [right, bottom] = [width - MARGIN.right, height - MARGIN.bottom];
    const x = (distance) => MARGIN.left + ((right - MARGIN.left) * distance) / end;
    const y = (metres) => bottom - ((bottom - MARGIN.top) * (metres - low)) / (high - low);
    return { width, height, right, bottom, low, high, end, x, y };
  }

  #draw() {
    if (!this.#data) return;
    const frame = this.#frame();
    const root = svg('svg', { width: frame.width, height: frame.height, viewBox: `0 0 ${frame.width} ${frame.height}` });
    root.append(...axes(frame), ...this.#corners.slice(1, -1).map((at) => svg('line', { class: 'corner', x1: frame.x(at), x2: frame.x(at), y1: MARGIN.top, y2: frame.bottom })));
    const { area, line } = paths(this.#data, frame);
    root.append(svg('path', { class: 'area', d: area }), svg('path', { class: 'line', d: line }), svg('g', { class: 'cursor' }));
    this.#box.replaceChildren(root);
    this.#drawCursor(frame);
  }

  #drawCursor(frame) {
    const group = this.#box.querySelector('.cursor');
    const height = this.cursor === null ? null : this.#data.height_m[this.cursor];
    group?.replaceChildren();
    if (!group || height === null) return;
    const distance = this.#data.distance_m[this.cursor];
    const [x, y] = [frame.x(distance), frame.y(height)];
    const words = t('profile_at', { distance: format.length(distance), height: format.height(height, this.#data.spacing_m) });
    const isLeft = x < frame.width / 2;
    const label = svg('text', { x: x + (isLeft ? 8 : -8), y: MARGIN.top + 11, 'text-anchor': isLeft ? 'start' : 'end' }, words);
    group.append(svg('line', { x1: x, x2: x, y1: MARGIN.top, y2: frame.bottom }), svg('circle', { cx: x, cy: y, r: 4 }), label);
  }

  #point(xPx) {
    if (!this.#data) return;
    const { x, end } = this.#frame();
    const distance = ((xPx - x(0)) / (x(end) - x(0))) * end;
    const last = this.#data.distance_m.length - 1;
    this.#set(Math.max(0, Math.min(last, Math.round((distance / end) * last))));
  }

  #key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -20, PageUp: 20, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined || !this.#data) return;
    event.preventDefault();
    const last = this.#data.distance_m.length - 1;
    this.#set(Math.max(0, Math.min(last, (this.cursor ?? 0) + step)));
    const height = this.#data.height_m[this.cursor];
    const words = { distance: format.length(this.#data.distance_m[this.cursor]), height: height === null ? '–' : format.height(height, this.#data.spacing_m) };
    this.#box.setAttribute('aria-label', t('profile_at', words));
  }

  #set(cursor) {
    if (cursor === this.cursor) return;
    this.cursor = cursor;
    if (this.#data) this.#drawCursor(this.#frame());
    this.#moved();
  }
}

/** Area and line through the known heights, in pieces where some are not known. */
function paths({ distance_m: distances, height_m: heights }, { x, y, bottom }) {
  let [area, line, from] = ['', '', null];
  const end = (at) => {
    if (from !== null) area += `L${x(distances[at]).toFixed(1)} ${bottom}L${x(distances[from]).toFixed(1)} ${bottom}Z`;
    from = null;
  };
  heights.forEach((height, i) => {
    if (height === null) return end(i - 1);
    const step = `${from === null ? 'M' : 'L'}${x(distances[i]).toFixed(1)} ${y(height).toFixed(1)}`;
    from ??= i;
    area += step;
    line += step;
  });
  end(heights.length - 1);
  return { area, line };
}

function axes({ right, bottom, low, high, end, x, y }) {
  const parts = [];
  for (const metres of ticks(low, high, (bottom - MARGIN.top) / 34)) {
    parts.push(svg('line', { class: 'grid', x1: MARGIN.left, x2: right, y1: y(metres), y2: y(metres) }));
    parts.push(svg('text', { class: 'tick', x: MARGIN.left - 6, y: y(metres) + 4, 'text-anchor': 'end' }, `${format.short(metres)} m`));
  }
  for (const distance of ticks(0, end, (right - MARGIN.left) / 110)) {
    const anchor = distance > 0.95 * end ? 'end' : 'middle';
    parts.push(svg('line', { class: 'axis', x1: x(distance), x2: x(distance), y1: bottom, y2: bottom + 4 }));
    parts.push(svg('text', { class: 'tick', x: x(distance), y: bottom + 17, 'text-anchor': anchor }, format.length(distance)));
  }
  parts.push(svg('line', { class: 'axis', x1: MARGIN.left, x2: right, y1: bottom, y2: bottom }));
  return parts;
}

/** Round numbers in a range, about so many. */
export function ticks(low, high, about) {
  const rough = (high - low) / Math.max(1, Math.floor(about));
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * unit).find((size) => size >= rough) ?? 10 * unit;
  const found = [];
  for (let i = Math.ceil(low / step); i <= Math.floor(high / step) && found.length < 50; i += 1) found.push(Number((i * step).toPrecision(12)));
  return found;
}
