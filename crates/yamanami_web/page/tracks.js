// Lines and places from GPX and GeoJSON, in longitude and latitude. What a file cannot be is told in words.

import { t } from './i18n.js';

export const MOST_BYTES = 32 * 2 ** 20;
const MOST_POINTS = 200_000;
const DEEPEST = 8;

/** { lines: [[lon, lat, lon, lat, ...]], places: [{ name, lon, lat }] }; throws an Error that says why not. */
export function parseTracks(name, text) {
  const start = text.trimStart().slice(0, 1);
  if (start === '<' || /\.gpx$/i.test(name)) return parseGpx(text);
  if (start === '{' || start === '[' || /json$/i.test(name)) return parseGeoJson(text);
  throw new Error(t('why_kind'));
}

class Collected {
  lines = [];
  places = [];
  #points = 0;

  point(lon, lat) {
    const isNumber = typeof lon === 'number' && typeof lat === 'number' && Number.isFinite(lon) && Number.isFinite(lat);
    if (!isNumber) return false;
    if (Math.abs(lon) > 360 || Math.abs(lat) > 90) throw new Error(t('why_crs'));
    this.#points += 1;
    if (this.#points > MOST_POINTS) throw new Error(t('why_many', { most: MOST_POINTS }));
    return true;
  }

  /** A line from pairs. */
  line(pairs) {
    const line = [];
    for (const [lon, lat] of pairs) if (this.point(lon, lat)) line.push(lon, lat);
    if (line.length >= 4) this.lines.push(line);
  }

  place(name, lon, lat) {
    if (this.point(lon, lat)) this.places.push({ name: String(name ?? '').slice(0, 80), lon, lat });
  }

  done() {
    if (this.lines.length + this.places.length === 0) throw new Error(t('why_empty'));
    return { lines: this.lines, places: this.places };
  }
}

function parseGpx(text) {
  const document = new DOMParser().parseFromString(text, 'application/xml');
  if (document.querySelector('parsererror')) throw new Error(t('why_xml'));
  const root = document.documentElement;
  if (root.localName !== 'gpx') throw new Error(t('why_gpx', { root: root.localName.slice(0, 40) }));
  const all = (parent, name) => [...parent.getElementsByTagNameNS('*', name)];
  const number = (element, name) => {
    const value = element.getAttribute(name)?.trim();
    return value ? Number(value) : NaN;
  };
  const pair = (element) => [number(element, 'lon'), number(element, 'lat')];
  const collected = new Collected();
  for (const segment of all(root, 'trkseg')) collected.line(all(segment, 'trkpt').map(pair));
  for (const route of all(root, 'rte')) collected.line(all(route, 'rtept').map(pair));
  for (const place of all(root, 'wpt')) collected.place(all(place, 'name')[0]?.textContent?.trim(), ...pair(place));
  return collected.done();
}

function parseGeoJson(text) {
  let root;
  try {
    root = JSON.parse(text);
  } catch {
    throw new Error(t('why_json'));
  }
  if (typeof root?.type !== 'string') throw new Error(t('why_geojson'));
  const collected = new Collected();
  walk(collected, root, '', 0);
  return collected.done();
}

/** A GeoJSON object and what is in it (RFC 7946). */
function walk(collected, object, name, depth) {
  if (depth > DEEPEST || typeof object !== 'object' || object === null) return;
  const list = (value) => (Array.isArray(value) ? value : []);
  const pairs = (value) => list(value).filter(Array.isArray);
  const place = (pair) => collected.place(name, pair?.[0], pair?.[1]);
  const coordinates = object.coordinates;
  switch (object.type) {
    case 'FeatureCollection':
      for (const feature of list(object.features)) walk(collected, feature, name, depth + 1);
      break;
    case 'Feature':
      walk(collected, object.geometry, object.properties?.name ?? object.properties?.title ?? '', depth + 1);
      break;
    case 'GeometryCollection':
      for (const geometry of list(object.geometries)) walk(collected, geometry, name, depth + 1);
      break;
    case 'Point':
      place(coordinates);
      break;
    case 'MultiPoint':
      list(coordinates).forEach(place);
      break;
    case 'LineString':
      collected.line(pairs(coordinates));
      break;
    case 'MultiLineString':
    case 'Polygon':
      for (const line of list(coordinates)) collected.line(pairs(line));
      break;
    case 'MultiPolygon':
      for (const polygon of list(coordinates)) for (const ring of list(polygon)) collected.line(pairs(ring));
      break;
    default:
  }
}
