// Deep links: what is shown, as the part of the address after #. Nonsense in it is told and left out.

import { decode, encode } from './rison.js';
import { LANGUAGES } from './i18n.js';

/** Longest link that is read. */
const MOST_CHARACTERS = 4000;

const number = (least, most) => (value) => typeof value === 'number' && value >= least && value <= most;
const whole = (least, most) => (value) => Number.isInteger(value) && value >= least && value <= most;
const yesOrNo = (value) => typeof value === 'boolean';
const oneOf = (...words) => (value) => words.includes(value);
const orNull = (check) => (value) => value === null || check(value);
const word = (value) => typeof value === 'string' && /^[a-z]{1,20}$/.test(value);

/** Settings in a link: short key, place in the settings, what makes sense. */
const SETTINGS = {
  m: ['mode', oneOf('relief', 'map')],
  t: ['tolerance_px', number(0.01, 1000)],
  tm: ['tolerance_m', number(0, 1e6)],
  b: ['budget', orNull(whole(10, 1e8))],
  k: ['control', oneOf('exact', 'paper')],
  ki: ['intervals', whole(1, 64)],
  kg: ['gain', number(0, 10)],
  rb: ['rebuild', yesOrNo],
  mo: ['morph', yesOrNo],
  e: ['wireframe', yesOrNo],
  c: ['colour', word],
  h: ['haze', yesOrNo],
  aa: ['antialias', yesOrNo],
  w: ['water_m', orNull(number(-12_000, 10_000))],
  sa: ['sun_azimuth_deg', number(-360, 360)],
  sh: ['sun_altitude_deg', number(1, 90)],
  a: ['map.alpha', number(0, 1)],
  af: ['map.alpha_fall', number(0, 100)],
  r: ['map.ring_km', number(0.001, 10_000)],
  z: ['map.eye_m', number(1, 1e6)],
  x: ['map.exaggeration', number(0.01, 100)],
  cu: ['map.curvature', oneOf('none', 'ring', 'centre')],
  rk: ['map.radius_km', number(0.01, 10_000)],
  ve: ['map.veil', yesOrNo],
  up: ['map.up_deg', number(-360, 360)],
};

const at = (settings, path) => path.split('.').reduce((value, key) => value?.[key], settings);

/** Reads a link: { surface, language, gpu, view, settings } with what is there and makes sense, and `ignored`, what is not. */
export function readHash(hash) {
  const link = { surface: null, language: null, gpu: 'auto', view: null, settings: {}, ignored: [] };
  const text = hash.replace(/^#/, '');
  if (text.length > MOST_CHARACTERS) {
    link.ignored.push(`${text.slice(0, 20)}…`);
    return link;
  }
  for (const part of text.split('&').filter((p) => p !== '')) {
    if (!readPart(link, part)) link.ignored.push(part.length > 40 ? `${part.slice(0, 40)}…` : part);
  }
  return link;
}

function readPart(link, part) {
  const cut = part.indexOf('=');
  const key = part.slice(0, Math.max(cut, 0));
  let text;
  try {
    text = decodeURIComponent(part.slice(cut + 1));
  } catch {
    return false;
  }
  if (key === 's' && text !== '') link.surface = text;
  else if (key === 'l' && LANGUAGES.includes(text)) link.language = text;
  else if (key === 'gpu' && ['auto', 'webgpu', 'webgl2'].includes(text)) link.gpu = text;
  else if (key === 'v') return readView(link, decode(text));
  else if (Object.hasOwn(SETTINGS, key)) return readSetting(link, key, decode(text));
  else return false;
  return true;
}

function readView(link, view) {
  if (typeof view !== 'object' || view === null) return false;
  link.view = JSON.stringify(view);
  return true;
}

function readSetting(link, key, value) {
  const [path, makesSense] = SETTINGS[key];
  if (!makesSense(value)) return false;
  const [first, second] = path.split('.');
  if (second) (link.settings[first] ??= {})[second] = value;
  else link.settings[first] = value;
  return true;
}

/** Writes a link; of the settings what differs from `usual`. */
export function writeHash({ surface, language, gpu, view, settings, usual }) {
  const parts = [`s=${encodeURIComponent(surface)}`];
  if (view) parts.push(`v=${encode(JSON.parse(view))}`);
  for (const [key, [path]] of Object.entries(SETTINGS)) {
    const value = at(settings, path);
    if (value !== undefined && value !== at(usual, path)) parts.push(`${key}=${encode(value)}`);
  }
  if (language) parts.push(`l=${language}`);
  if (gpu && gpu !== 'auto') parts.push(`gpu=${gpu}`);
  return `#${parts.join('&')}`;
}
