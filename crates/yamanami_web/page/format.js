// Numbers for people, in the page's language.

import { currentLanguage, t } from './i18n.js';

/** A number with at most so many digits after the point. */
export function number(value, digits = 0) {
  if (!Number.isFinite(value)) return '–';
  return new Intl.NumberFormat(currentLanguage(), { maximumFractionDigits: digits, minimumFractionDigits: 0 }).format(value);
}

/** A number with about three digits that count. */
export function short(value) {
  if (!Number.isFinite(value)) return '–';
  const digits = Math.abs(value) >= 1e5 ? undefined : 3;
  if (digits) return new Intl.NumberFormat(currentLanguage(), { maximumSignificantDigits: Math.max(digits, wholeDigits(value)) }).format(value);
  return number(value);
}

function wholeDigits(value) {
  return Math.max(1, Math.ceil(Math.log10(Math.abs(value) + 1)));
}

export function length(metres) {
  if (Math.abs(metres) >= 10_000) return `${number(metres / 1000, 1)} km`;
  if (Math.abs(metres) >= 1000) return `${number(metres / 1000, 2)} km`;
  return `${short(metres)} m`;
}

/** A height: metres, as fine as the surface's data deserve. */
export function height(metres, spacing) {
  const finest = spacing ?? 1;
  return `${number(metres, finest < 0.5 ? 3 : finest < 5 ? 1 : 0)} m`;
}

export function bytes(count) {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  const step = Math.min(units.length - 1, Math.max(0, Math.floor(Math.log10(Math.max(count, 1)) / 3)));
  const value = count / 1000 ** step;
  return `${number(value, value < 10 && step > 0 ? 1 : 0)} ${units[step]}`;
}

/** Longitude and latitude, degrees. */
export function lonLat([lon, lat]) {
  const part = (value, plus, minus) => {
    const degrees = `${number(Math.abs(value), 5)}°`;
    const side = t(value < 0 ? minus : plus);
    return side.length > 1 ? side + degrees : `${degrees} ${side}`;
  };
  return `${part(lat, 'north', 'south')}, ${part(lon, 'east', 'west')}`;
}

/** The direction of an azimuth, in words. */
export function direction(azimuthDeg) {
  return t('directions').split(' ')[Math.round(azimuthDeg / 45) & 7] ?? '';
}
