// The languages of the page: words by key, and elements that carry keys.

import { en } from './words_en.js';
import { ja } from './words_ja.js';

const WORDS = { en, ja };
export const LANGUAGES = Object.keys(WORDS);
const listeners = new Set();
let language = 'en';

/** The browser's language where the page speaks it. */
export function usualLanguage() {
  const wanted = navigator.languages ?? [navigator.language];
  return wanted.map((tag) => tag.slice(0, 2).toLowerCase()).find((tag) => tag in WORDS) ?? 'en';
}

export function currentLanguage() {
  return language;
}

/** The words of a key, with {names} filled in. */
export function t(key, values = {}) {
  const words = WORDS[language][key] ?? WORDS.en[key] ?? key;
  return words.replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

/** Fills the elements below `root` that carry keys: data-t is their text, data-t-label their name for hands and ears. */
export function translate(root = document) {
  for (const element of root.querySelectorAll('[data-t]')) element.textContent = t(element.dataset.t);
  for (const element of root.querySelectorAll('[data-t-label]')) {
    const words = t(element.dataset.tLabel);
    element.setAttribute('aria-label', words);
    if (element.tagName === 'BUTTON') element.title = words;
  }
}

export function setLanguage(code) {
  language = code in WORDS ? code : 'en';
  document.documentElement.lang = language;
  translate();
  for (const listener of listeners) listener();
}

/** Calls `listener` whenever the language changes. */
export function onLanguage(listener) {
  listeners.add(listener);
}
