// The row of buttons beside the picture.

import { icon } from './icons.js';
import { t } from './i18n.js';
import { make } from './widgets.js';

/** Name, icon and words of each button; `isOn` for those that stay pressed. */
const BUTTONS = [
  ['home', 'home', 'home'],
  ['nearer', 'nearer', 'nearer'],
  ['farther', 'farther', 'farther'],
  ['drag', 'turn', 'drag_turns'],
  ['fly', 'fly', 'fly'],
  ['map', 'map', 'map_mode'],
  ['profile', 'profile', 'profile_tool'],
  ['picture', 'picture', 'picture'],
  ['full', 'full', 'full'],
  ['help', 'help', 'help'],
];
const PRESSED = ['fly', 'map', 'profile'];

export class Tools {
  #buttons = {};

  /** `act(name)` hears of presses. */
  constructor(act) {
    const nav = document.getElementById('tools');
    for (const [name, picture, words] of BUTTONS) {
      const button = make('button', { type: 'button', id: `tool-${name}` }, icon(picture));
      button.dataset.tLabel = words;
      if (PRESSED.includes(name)) button.setAttribute('aria-pressed', 'false');
      button.addEventListener('click', () => act(name));
      this.#buttons[name] = button;
      nav.append(button);
    }
  }

  press(name, isOn) {
    this.#buttons[name].setAttribute('aria-pressed', String(isOn));
  }

  offer(name, isOffered) {
    this.#buttons[name].hidden = !isOffered;
  }

  enable(name, isEnabled) {
    this.#buttons[name].disabled = !isEnabled;
  }

  /** What a plain drag does. */
  showDrag(moves) {
    const button = this.#buttons.drag;
    button.replaceChildren(icon(moves ? 'pan' : 'turn'));
    button.dataset.tLabel = moves ? 'drag_moves' : 'drag_turns';
    button.title = t(button.dataset.tLabel);
    button.setAttribute('aria-label', button.title);
  }
}
