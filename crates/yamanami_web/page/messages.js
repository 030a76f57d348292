// What the page tells: short messages that go by themselves, and alarms that stay until they are answered.

import { t } from './i18n.js';

const SHOWN_MS = 7000;
const MOST_SHOWN = 3;

const list = () => document.getElementById('messages');

/** Says something; messages of one `kind` replace each other. A `kind` that `stays` does so until it is taken back. */
export function say(text, { kind = text, stays = false } = {}) {
  unsay(kind);
  const message = document.createElement('p');
  message.dataset.kind = kind;
  message.textContent = text;
  list().append(message);
  while (list().children.length > MOST_SHOWN) list().firstElementChild.remove();
  if (!stays) setTimeout(() => message.remove(), SHOWN_MS);
}

/** Takes a message back. */
export function unsay(kind) {
  for (const message of [...list().children]) if (message.dataset.kind === kind) message.remove();
}

/** Something that ends the picture, with a button that goes on. */
export function alarm(text, button, act) {
  const box = document.getElementById('alarm');
  const words = document.createElement('p');
  words.textContent = text;
  const go = document.createElement('button');
  go.type = 'button';
  go.textContent = t(button);
  go.addEventListener('click', () => {
    box.hidden = true;
    act();
  });
  box.replaceChildren(words, go);
  box.hidden = false;
  go.focus({ preventScroll: true });
}

/** The page says why it shows nothing. */
export function block(text, detail = '') {
  document.getElementById('loading').hidden = true;
  const box = document.createElement('div');
  box.className = 'blocked';
  box.setAttribute('role', 'alert');
  const heading = document.createElement('h2');
  heading.textContent = t('blocked_title');
  const words = document.createElement('p');
  words.textContent = text;
  const more = document.createElement('p');
  more.className = 'detail';
  more.textContent = detail;
  box.append(heading, words, more);
  document.querySelector('.blocked')?.remove();
  document.body.append(box);
}
