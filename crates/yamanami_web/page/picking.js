// What the place under the pointer is: read once a frame, shown in a line.

import * as format from './format.js';
import { onLanguage, t } from './i18n.js';
import { make } from './widgets.js';

export class Picking {
  #output = document.getElementById('readout');
  #asked = null;
  #last = null;
  #facts = null;

  constructor() {
    onLanguage(() => this.#show(this.#last));
  }

  open(facts) {
    this.#facts = facts;
    this.#last = this.#asked = null;
    this.#show(null);
  }

  /** Reads this place, device pixels, with the next frame; null reads none. */
  ask(place, isAloud = false) {
    this.#asked = { place };
    this.#output.setAttribute('aria-live', isAloud ? 'polite' : 'off');
  }

  /** Reads what was asked for, or again where finer data may have come. */
  update(viewer, again) {
    if (!this.#asked && !(again && this.#last?.place)) return;
    const place = this.#asked ? this.#asked.place : this.#last.place;
    this.#asked = null;
    const found = place && pick(viewer, place);
    this.#last = { place, found };
    this.#show(this.#last);
  }

  #show(last) {
    const found = last?.found;
    this.#output.replaceChildren(...(found ? this.#parts(found) : [make('span', { className: 'none', textContent: t('pick_none') })]));
  }

  #parts(found) {
    const isModel = this.#facts?.kind === 'model';
    const fine = found.spacing_m ?? this.#facts?.step_m ?? 1;
    const parts = [['place', found.lon_lat ? format.lonLat(found.lon_lat) : found.source.map((value) => format.short(value)).join(', ')]];
    if (Number.isFinite(found.height_m)) parts.push(['height', format.height(found.height_m, fine), isModel ? '' : t('height')]);
    if (Number.isFinite(found.slope_deg)) {
      const falls = !isModel && found.slope_deg > 1 && Number.isFinite(found.aspect_deg) ? ` (${t('falls', { direction: format.direction(found.aspect_deg) })})` : '';
      parts.push(['slope', `${format.number(found.slope_deg)}°${falls}`, t('slope')]);
    }
    if (Number.isFinite(found.distance_m)) parts.push(['away', t('away', { distance: format.length(found.distance_m) })]);
    if (found.exact === false) parts.push(['coarse', t('pick_coarse')]);
    return parts.map(([name, text, label]) => {
      const span = make('span', { className: name, textContent: text });
      if (label) span.prepend(make('small', { textContent: label }), ' ');
      return span;
    });
  }
}

/** The place of the surface under a pixel, or null. */
export function pick(viewer, [xPx, yPx]) {
  const text = viewer.pick(xPx, yPx);
  return text === undefined ? null : JSON.parse(text);
}
