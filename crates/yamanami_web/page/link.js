// The address follows what is shown, so that it can be given to others.

import { writeHash } from './hash.js';
import { currentLanguage, usualLanguage } from './i18n.js';

/** It does so after the view has rested so long. */
const AFTER_MS = 400;

export class Link {
  #timer = 0;
  #first;

  /** `first` is the link that the page was opened by: it keeps language and graphics interface. */
  constructor(first) {
    this.#first = first;
  }

  follow(session) {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#write(session), AFTER_MS);
  }

  #write(session) {
    const { surface, usual, facts, viewer } = session;
    if (!facts || !viewer || session.isPending) return;
    const isUsual = currentLanguage() === usualLanguage() && !this.#first.language;
    const hash = writeHash({
      surface: surface.name,
      language: isUsual ? null : currentLanguage(),
      gpu: this.#first.gpu,
      view: session.view(),
      settings: session.settings,
      usual,
    });
    if (hash !== location.hash) history.replaceState(null, '', hash);
  }
}
