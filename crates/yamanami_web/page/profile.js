// The profile tool: a line over the surface by two or more places, and the heights along it.

import { download } from './download.js';
import * as format from './format.js';
import { icon } from './icons.js';
import { onLanguage, t } from './i18n.js';
import { say } from './messages.js';
import { Plot } from './plot.js';
import { make } from './widgets.js';

const SAMPLES = 400;
const MOST_PLACES = 100;
/** While finer data come, the profile is read again after so long. */
const AGAIN_MS = 400;

export class Profile {
  #viewer = null;
  #surface = null;
  #places = [];
  #data = null;
  #readMs = 0;
  #section = document.getElementById('profile');
  #plot;
  #redraw;
  isOn = false;

  /** `redraw()` draws the line over the picture anew; `toggle()` closes the tool. */
  constructor(redraw, toggle) {
    this.#redraw = redraw;
    this.#plot = new Plot(document.getElementById('plot'), redraw);
    const button = (picture, words, act) => {
      const made = make('button', { type: 'button', className: 'plain' }, icon(picture));
      made.dataset.tLabel = words;
      made.addEventListener('click', act);
      return made;
    };
    this.#section.querySelector('.buttons').append(
      button('undo', 'profile_undo', () => this.undo()),
      button('save', 'profile_csv', () => this.save()),
      button('close', 'profile_close', toggle),
    );
    onLanguage(() => this.#show());
  }

  open(viewer, surface) {
    this.#viewer = viewer;
    this.#surface = surface;
    this.#places = [];
    this.#data = null;
    this.#show();
  }

  /** The viewer was made anew: the line stays. */
  takeOver(viewer) {
    this.#viewer = viewer;
    this.#read();
  }

  toggle(isOn) {
    this.isOn = isOn;
    this.#section.hidden = !isOn;
    document.body.classList.toggle('profiling', isOn);
    if (!isOn) {
      this.#places = [];
      this.#data = null;
      this.#viewer?.clear_profile();
    }
    this.#show();
  }

  /** Adds a place that was picked. */
  add(found) {
    if (this.#places.length >= MOST_PLACES) return;
    this.#places.push(found.local);
    this.#read();
  }

  undo() {
    this.#places.pop();
    this.#read();
  }

  /** Reads again while it is not exact. */
  update(nowMs) {
    if (this.isOn && this.#data && !this.#data.exact && nowMs - this.#readMs > AGAIN_MS) this.#read();
    return this.isOn && this.#data !== null && !this.#data.exact;
  }

  get data() {
    return this.#data;
  }

  /** What lies over the picture: the line on the land, its places, and the place read off the plot. */
  marks() {
    if (!this.isOn || this.#places.length === 0) return null;
    const line = this.#data ? this.#onLand() : new Float64Array(this.#places.flat());
    const at = this.#plot.cursor;
    const cursor = this.#data && at !== null ? line.slice(3 * at, 3 * at + 3) : null;
    return { line, places: new Float64Array(this.#places.flat()), cursor };
  }

  #read() {
    this.#data = null;
    if (this.#places.length >= 2) {
      const line = new Float64Array(this.#places.flatMap(([x, y]) => [x, y]));
      try {
        this.#data = JSON.parse(this.#viewer.profile(line, SAMPLES));
      } catch (error) {
        say(error.message, { kind: 'profile' });
      }
    } else {
      this.#viewer?.clear_profile();
    }
    this.#readMs = performance.now();
    this.#show();
    this.#redraw();
  }

  /** The samples' places, flat triples; local z is the height but for a constant. */
  #onLand() {
    const { distance_m: distances, height_m: heights } = this.#data;
    const corners = cornersOf(this.#places);
    const points = new Float64Array(3 * distances.length);
    let leg = 0;
    distances.forEach((distance, sample) => {
      while (leg + 2 < corners.length && distance > corners[leg + 1]) leg += 1;
      const share = (distance - corners[leg]) / (corners[leg + 1] - corners[leg] || 1);
      const [a, b] = [this.#places[leg], this.#places[leg + 1]];
      for (const axis of [0, 1]) points[3 * sample + axis] = a[axis] + (b[axis] - a[axis]) * share;
      points[3 * sample + 2] = heights[sample] ?? NaN;
    });
    return points;
  }

  #show() {
    const data = this.#data;
    const facts = document.getElementById('profile-facts');
    if (!data) {
      facts.textContent = t('profile_start');
      this.#plot.clear();
      return;
    }
    const numbers = summary(data);
    const words = {
      length: format.length(numbers.lengthM),
      min: format.height(numbers.minM, data.spacing_m),
      max: format.height(numbers.maxM, data.spacing_m),
      ascent: format.height(numbers.ascentM, data.spacing_m),
      descent: format.height(numbers.descentM, data.spacing_m),
    };
    const state = data.exact ? t('profile_exact', { spacing: format.length(data.spacing_m ?? NaN) }) : t('profile_coarse');
    facts.textContent = `${t('profile_facts', words)} · ${state}`;
    this.#plot.show(data, cornersOf(this.#places), t('profile_aria', words));
  }

  /** Saves what is plotted as a table. */
  save() {
    if (!this.#data) return;
    const points = this.#onLand();
    const xy = new Float64Array((points.length / 3) * 2);
    for (let i = 0; i < xy.length / 2; i += 1) xy.set([points[3 * i], points[3 * i + 1]], 2 * i);
    const places = this.#viewer.lon_lat_from_local(xy);
    const rows = this.#data.distance_m.map((distance, i) => {
      const height = this.#data.height_m[i];
      const [lon, lat] = [places[2 * i], places[2 * i + 1]].map((value) => (Number.isFinite(value) ? value.toFixed(7) : ''));
      return [distance.toFixed(3), height === null ? '' : height.toFixed(3), lon ?? '', lat ?? ''].join(',');
    });
    const text = `distance_m,height_m,lon,lat\r\n${rows.join('\r\n')}\r\n`;
    download(new Blob([text], { type: 'text/csv' }), `${this.#surface.name}-profile.csv`);
  }
}

/** Distances of the places along the line. */
function cornersOf(places) {
  const distances = [0];
  for (let i = 1; i < places.length; i += 1) {
    const [a, b] = [places[i - 1], places[i]];
    distances.push(distances[i - 1] + Math.hypot(b[0] - a[0], b[1] - a[1]));
  }
  return distances;
}

/** Length, least and greatest height, ascent and descent over all samples. */
export function summary({ distance_m: distances, height_m: heights }) {
  const known = heights.filter((height) => height !== null);
  let [ascentM, descentM] = [0, 0];
  for (let i = 1; i < known.length; i += 1) {
    const rise = known[i] - known[i - 1];
    if (rise > 0) ascentM += rise;
    else descentM -= rise;
  }
  const least = (a, b) => Math.min(a, b);
  const most = (a, b) => Math.max(a, b);
  return { lengthM: distances.at(-1) ?? 0, minM: known.reduce(least, Infinity), maxM: known.reduce(most, -Infinity), ascentM, descentM };
}
