// Mouse, pen and fingers on the picture. Places are device pixels of the canvas.

import { density } from './loop.js';

/** A press that moves less than this is a click, CSS pixels. */
const CLICK_PX = 6;
/** A second tap within so long, and so near, is a double tap. */
const DOUBLE_MS = 350;
const DOUBLE_PX = 28;
/** What a double tap does to the distance, and one notch of a wheel. */
const DOUBLE_FACTOR = 0.5;
const WHEEL_RATE = 0.0016;
/** Pixels of turning for a radian of twist. */
const TWIST_PX_PER_RAD = 1 / 0.0045;

/**
 * Hears the stage. `target` has viewer (or null), wake(), isMap(), click(xPx, yPx, pointerType), hover(xPx, yPx) and leave();
 * `tool.moves` says that a plain drag moves instead of turning.
 */
export function listen(stage, target, tool) {
  const pointers = new Map();
  let pressed = null;
  let lastTap = null;

  const place = (event) => {
    const box = stage.getBoundingClientRect();
    return [(event.clientX - box.left) * density(), (event.clientY - box.top) * density()];
  };

  const down = (event) => {
    if (event.target.closest('button, a, input')) return;
    stage.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    const isSecond = event.button !== 0 || event.shiftKey || event.ctrlKey || event.metaKey;
    pressed = pointers.size === 1 ? { at: place(event), isClick: event.button === 0, isSecond } : null;
  };

  const move = (event) => {
    const to = place(event);
    const from = pointers.get(event.pointerId);
    if (!from) {
      if (event.pointerType !== 'touch') target.hover(...to);
      return;
    }
    const viewer = target.viewer;
    if (pointers.size === 1 && pressed) {
      if (pressed.isClick && distance(to, pressed.at) < CLICK_PX * density()) return;
      pressed.isClick = false;
      if (viewer) drag(viewer, from, to, (target.isMap() || tool.moves) !== pressed.isSecond);
    } else if (pointers.size === 2 && viewer) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      pinch(viewer, [from, other], [to, other]);
    }
    pointers.set(event.pointerId, to);
    target.wake();
  };

  const up = (event) => {
    const at = place(event);
    const isClick = pressed?.isClick && pointers.size === 1 && event.type === 'pointerup';
    pointers.delete(event.pointerId);
    pressed = null;
    if (!isClick) return;
    if (lastTap && event.timeStamp - lastTap.timeMs < DOUBLE_MS && distance(at, lastTap.at) < DOUBLE_PX * density()) {
      lastTap = null;
      target.viewer?.zoom(DOUBLE_FACTOR, ...at);
      target.wake();
    } else {
      lastTap = { at, timeMs: event.timeStamp };
      target.click(...at, event.pointerType);
    }
  };

  const wheel = (event) => {
    event.preventDefault();
    const scale = [1, 16, 400][event.deltaMode] ?? 1;
    const turned = Math.max(-400, Math.min(400, event.deltaY * scale));
    // a pinch on a touch pad arrives as a wheel with Ctrl, in smaller steps
    const rate = event.ctrlKey ? 6 * WHEEL_RATE : WHEEL_RATE;
    target.viewer?.zoom(Math.exp(turned * rate), ...place(event));
    target.wake();
  };

  stage.addEventListener('pointerdown', down);
  stage.addEventListener('pointermove', move);
  stage.addEventListener('pointerup', up);
  stage.addEventListener('pointercancel', up);
  stage.addEventListener('pointerleave', () => target.leave());
  stage.addEventListener('wheel', wheel, { passive: false });
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
}

function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

function drag(viewer, from, to, moves) {
  if (moves) viewer.pan(...from, ...to);
  else viewer.turn((to[0] - from[0]) / density(), (to[1] - from[1]) / density());
}

/** Two fingers: their middle moves the land, their distance scales it, their direction turns it. */
function pinch(viewer, from, to) {
  const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const angle = ([a, b]) => Math.atan2(b[1] - a[1], b[0] - a[0]);
  const [before, after] = [distance(...from), distance(...to)];
  viewer.pan(...middle(from), ...middle(to));
  if (before > 1 && after > 1) viewer.zoom(before / after, ...middle(to));
  let twistRad = angle(to) - angle(from);
  if (twistRad > Math.PI) twistRad -= 2 * Math.PI;
  if (twistRad < -Math.PI) twistRad += 2 * Math.PI;
  if (before > 40) viewer.turn(-twistRad * TWIST_PX_PER_RAD, 0);
}
