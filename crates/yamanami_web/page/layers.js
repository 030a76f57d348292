// Files laid over the surface: their lines and places on the land as it is known now.

import * as format from './format.js';
import { t } from './i18n.js';
import { say } from './messages.js';
import { MOST_BYTES, parseTracks } from './tracks.js';

const COLOURS = ['#c8321e', '#1d5fb4', '#8a3fa0', '#b06a00', '#00796b', '#4a4a4a'];
/** Long legs are cut into pieces of this share of the surface, so that they lie on the land. */
const PIECE = 1 / 400;
const MOST_VERTICES = 300_000;
/** While data arrive, places are put on the land again after so long. */
const AGAIN_MS = 600;

export class Layers {
  #viewer = null;
  #facts = null;
  #count = 0;
  #placedMs = 0;
  #isStale = false;
  files = [];

  open(viewer, facts) {
    this.#viewer = viewer;
    this.#facts = facts;
    for (const file of this.files) this.#place(file);
  }

  /** Reads files and adds those that can be shown; tells of each what came of it. */
  async add(blobs) {
    for (const blob of blobs) {
      try {
        await this.#addOne(blob);
      } catch (error) {
        say(t('file_broken', { name: blob.name, why: error.message }), { kind: blob.name });
      }
    }
  }

  remove(file) {
    this.files = this.files.filter((other) => other !== file);
  }

  /** New data arrived: the land may be another. */
  stale() {
    this.#isStale = true;
  }

  update(nowMs) {
    if (!this.#isStale || nowMs - this.#placedMs < AGAIN_MS) return;
    this.#isStale = false;
    this.#placedMs = nowMs;
    for (const file of this.files) this.#place(file);
  }

  async #addOne(blob) {
    const { name } = blob;
    if (!this.#facts?.centre_lon_lat) return say(t('file_no_place'), { kind: name });
    if (blob.size > MOST_BYTES) {
      return say(t('file_large', { name, size: format.bytes(blob.size), most: format.bytes(MOST_BYTES) }), { kind: name });
    }
    const { lines, places } = parseTracks(name, await blob.text());
    const file = { name, title: name, colour: COLOURS[this.#count % COLOURS.length], lines: lines.map((line) => this.#cut(line)), places };
    if (!this.#place(file)) return say(t('file_outside', { name }), { kind: name });
    this.#count += 1;
    this.files = [...this.files, file];
    say(t('file_shown', { name, lines: lines.length, places: places.length }), { kind: name });
  }

  /** The line with long legs cut into pieces. */
  #cut(line) {
    const { min, max } = this.#facts.bounds;
    const pieceM = Math.hypot(max[0] - min[0], max[1] - min[1]) * PIECE;
    const local = this.#viewer.local_from_lon_lat(new Float64Array(line));
    const cut = [line[0], line[1]];
    for (let i = 1; i < line.length / 2; i += 1) {
      const legM = Math.hypot(local[3 * i] - local[3 * i - 3], local[3 * i + 1] - local[3 * i - 2]);
      const pieces = cut.length < 2 * MOST_VERTICES && legM > pieceM ? Math.min(400, Math.ceil(legM / pieceM)) : 1;
      for (let piece = 1; piece <= pieces; piece += 1) {
        for (const axis of [0, 1]) cut.push(line[2 * i - 2 + axis] + ((line[2 * i + axis] - line[2 * i - 2 + axis]) * piece) / pieces);
      }
    }
    return new Float64Array(cut);
  }

  /** Puts a file on the land; whether any of it lies there. */
  #place(file) {
    file.onLand = file.lines.map((line) => this.#viewer.local_from_lon_lat(line));
    file.marks = this.#viewer.local_from_lon_lat(new Float64Array(file.places.flatMap(({ lon, lat }) => [lon, lat])));
    return [...file.onLand, file.marks].some((points) => points.some((value) => !Number.isNaN(value)));
  }
}
