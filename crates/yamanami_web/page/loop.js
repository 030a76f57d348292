// The viewer in a canvas: made, sized, driven frame by frame, and made anew when the graphics device is lost.

import init, { Viewer } from './yamanami_web.js';

/** Finer than this many device pixels for a CSS pixel is not drawn: it would cost more than it shows. */
const MOST_DENSITY = 2;
/** Longest step that a frame takes, so that a pause makes no jump. */
const LONGEST_STEP_S = 0.1;
/** Step of the first frame after a rest. */
const FIRST_STEP_S = 1 / 60;
/** A step that ends every movement: for readers who want none. */
const WHOLE_WAY_S = 30;

/** The engine, on its way while the page still reads what there is to show. */
let module = init();
// that it could not be had is told when a viewer is made
module.catch(() => { module = null; });
const wantsNoMotion = matchMedia('(prefers-reduced-motion: reduce)');

/** Puts a new canvas where the old one was, and a viewer into it: a canvas whose device was lost is of no more use. */
export async function makeViewer(stage, backend) {
  module ??= init();
  await module;
  const canvas = document.createElement('canvas');
  canvas.id = 'view';
  stage.querySelector('#view').replaceWith(canvas);
  const [width, height] = sizeOf(stage);
  Object.assign(canvas, { width, height });
  const viewer = await Viewer.create(canvas, backend);
  return { canvas, viewer };
}

/** Device pixels for a CSS pixel. */
export function density() {
  return Math.min(window.devicePixelRatio || 1, MOST_DENSITY);
}

function sizeOf(stage) {
  return [stage.clientWidth, stage.clientHeight].map((length) => Math.max(1, Math.round(length * density())));
}

export class Loop {
  #stage;
  #canvas;
  #viewer;
  #hooks;
  #scheduled = 0;
  #last = 0;
  #over = false;
  #size = [0, 0];

  /** Hooks: before(dtS) (true: go on calling), after(again), failed(error). */
  constructor(stage, canvas, viewer, hooks) {
    Object.assign(this, { wake: this.wake.bind(this) });
    this.#stage = stage;
    this.#canvas = canvas;
    this.#viewer = viewer;
    this.#hooks = hooks;
    this.observer = new ResizeObserver(this.wake);
    this.observer.observe(stage);
    // WebGL tells the canvas, and nobody else
    canvas.addEventListener('webglcontextlost', () => this.#fail(new Error('device lost: the browser took the context away')));
  }

  /** Asks for a frame. */
  wake() {
    if (this.#over || this.#scheduled) return;
    this.#scheduled = requestAnimationFrame((now) => this.#frame(now));
  }

  /** Draws now, so that the canvas can be read in the same turn. */
  drawNow() {
    this.#resize();
    this.#viewer.frame(0);
  }

  stop() {
    this.#over = true;
    cancelAnimationFrame(this.#scheduled);
    this.observer.disconnect();
  }

  #frame(now) {
    this.#scheduled = 0;
    const dtS = this.#last ? Math.min((now - this.#last) / 1000, LONGEST_STEP_S) : FIRST_STEP_S;
    let again;
    try {
      this.#resize();
      const driven = this.#hooks.before(dtS);
      again = this.#viewer.frame(wantsNoMotion.matches ? WHOLE_WAY_S : dtS) || driven;
      this.#hooks.after(again);
    } catch (error) {
      this.#fail(error);
      return;
    }
    this.#last = again ? now : 0;
    if (again) this.wake();
  }

  #fail(error) {
    if (this.#over) return;
    this.stop();
    this.#hooks.failed(error);
  }

  #resize() {
    const [width, height] = sizeOf(this.#stage);
    if (width === this.#size[0] && height === this.#size[1]) return;
    this.#size = [width, height];
    Object.assign(this.#canvas, { width, height });
    this.#viewer.resize(width, height);
  }
}
