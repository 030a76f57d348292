// The keyboard: keys that do something once, and keys held down to move.

/** Keys that move while held: axis and sign. */
const HELD = {
  KeyW: ['ahead', 1], ArrowUp: ['ahead', 1], KeyS: ['ahead', -1], ArrowDown: ['ahead', -1],
  KeyD: ['aside', 1], ArrowRight: ['aside', 1], KeyA: ['aside', -1], ArrowLeft: ['aside', -1],
  KeyE: ['up', 1], KeyQ: ['up', -1],
};

/** Keys that ask for something once. */
const ONCE = {
  '+': 'nearer', '=': 'nearer', '-': 'farther', _: 'farther', h: 'home', f: 'fly', m: 'map', p: 'profile', c: 'colour', l: 'edges',
  '?': 'help', escape: 'escape', enter: 'enter',
};

export class Keys {
  #held = new Set();
  #fast = false;

  /** `act(name)` hears of keys; `wake()` asks for frames while keys are held. */
  constructor(stage, act, wake) {
    document.addEventListener('keydown', (event) => {
      this.#fast = event.shiftKey;
      if (event.ctrlKey || event.metaKey || event.altKey || isTaken(event, stage)) return;
      if (event.code in HELD) {
        this.#held.add(event.code);
        event.preventDefault();
        wake();
        return;
      }
      const name = ONCE[event.key.toLowerCase()];
      if (!name || (event.repeat && name !== 'nearer' && name !== 'farther')) return;
      if (name === 'enter' && event.target !== stage) return;
      event.preventDefault();
      act(name);
    });
    document.addEventListener('keyup', (event) => {
      this.#fast = event.shiftKey;
      this.#held.delete(event.code);
    });
    addEventListener('blur', () => this.#held.clear());
  }

  /** What the keys held ask for, each axis from -1 to 1; null when none is held. */
  drive() {
    if (this.#held.size === 0) return null;
    const axes = { ahead: 0, aside: 0, up: 0 };
    for (const code of this.#held) axes[HELD[code][0]] += HELD[code][1];
    const unit = (value) => Math.max(-1, Math.min(1, value));
    return { ahead: unit(axes.ahead), aside: unit(axes.aside), up: unit(axes.up), fast: this.#fast };
  }
}

/** Pixels a second that keys move a map, and turn it by. */
const MAP_PX_PER_S = 400;

/** Moves and turns a deformed map by keys. */
export function driveMap({ viewer, canvas }, { ahead, aside, up, fast }, dtS) {
  const step = MAP_PX_PER_S * (fast ? 3 : 1) * dtS;
  const [x, y] = [canvas.width / 2, canvas.height / 2];
  viewer.pan(x, y, x - aside * step, y + ahead * step);
  if (up) viewer.turn(up * step, 0);
}

/** Whether what has the focus wants the key for itself. */
function isTaken(event, stage) {
  const target = event.target;
  if (target.closest?.('dialog')) return true;
  if (target.closest?.('select, textarea, input:not([type=checkbox]):not([type=range])')) return event.key !== 'Escape';
  const isArrow = event.key.startsWith('Arrow');
  return isArrow && target !== stage && target.closest?.('input, #plot, summary, button') !== null;
}
