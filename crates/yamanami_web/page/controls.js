// What the panel offers, as a table: sections of controls, each for one of the viewer's settings.
// A slider is { key, least, most, unit, log, step, none }: `log` counts by factors (and `zero` adds 0 below), `none` is the value to begin with of one that can be off.

const isExact = (settings) => settings.control !== 'paper';
const isPaper = (settings) => settings.control === 'paper';
const isMap = (settings) => settings.mode === 'map';
const isRelief = (settings) => !isMap(settings);

/** The sections for a surface. */
export function sections(facts) {
  const { min, max } = facts.bounds;
  const size = Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]) || 1;
  const isModel = facts.kind === 'model';
  return [
    {
      title: 'fineness',
      open: true,
      rows: [
        { key: 'control', choices: ['exact', 'paper'], when: isRelief },
        { key: 'tolerance_px', least: 0.1, most: 50, log: true, unit: 'px', when: (s) => isExact(s) || isMap(s) },
        { key: 'tolerance_m', least: size * 1e-6, most: size * 0.02, log: true, zero: true, unit: 'm', when: isRelief },
        { key: 'intervals', least: 1, most: 16, step: 1, when: (s) => isPaper(s) && isRelief(s) },
        { key: 'gain', least: 0.05, most: 1.5, step: 0.05, when: (s) => isPaper(s) && isRelief(s) },
        { key: 'budget', least: 500, most: 5_000_000, log: true, whole: true, none: 100_000 },
        { key: 'morph', flag: true, when: (s) => isExact(s) && isRelief(s) },
        { key: 'rebuild', flag: true, when: isRelief },
      ],
    },
    {
      title: 'map',
      open: true,
      when: isMap,
      rows: [
        { presets: presetsOf(facts.bounds), key: 'presets' },
        { key: 'map.alpha', least: 0, most: 1, step: 0.01 },
        { key: 'map.alpha_fall', least: 0, most: 4, step: 0.05 },
        { key: 'map.ring_km', least: 0.05, most: 100, log: true, unit: 'km' },
        { key: 'map.eye_m', least: 100, most: 30_000, log: true, whole: true, unit: 'm' },
        { key: 'map.exaggeration', least: 0.5, most: 5, log: true, unit: '×' },
        { key: 'map.radius_km', least: 0.1, most: 300, log: true, unit: 'km' },
        { key: 'map.curvature', choices: ['none', 'ring', 'centre'] },
        { key: 'map.veil', flag: true },
        { key: 'map.up_deg', least: 0, most: 360, step: 1, unit: '°' },
      ],
    },
    {
      title: 'looks',
      open: true,
      rows: [
        { key: 'colour', choices: facts.colours ?? [] },
        { key: 'sun_azimuth_deg', least: 0, most: 360, step: 1, unit: '°' },
        { key: 'sun_altitude_deg', least: 5, most: 90, step: 1, unit: '°' },
        { key: 'water_m', least: min[2], most: max[2], step: niceStep(max[2] - min[2]), unit: 'm', none: min[2] + (max[2] - min[2]) / 4, when: (s) => isRelief(s) && !isModel },
        { key: 'wireframe', flag: true },
        { key: 'haze', flag: true, when: isRelief },
        { key: 'antialias', flag: true },
      ],
    },
  ];
}

/** Numbers for a map of what is near and of what is far: shares of the surface, and eyes well above the land. */
function presetsOf({ min, max }) {
  const reachKm = Math.min(160, 0.0005 * Math.hypot(max[0] - min[0], max[1] - min[1]));
  const preset = (ringShare, radiusShare) => {
    const ringKm = Number((reachKm * ringShare).toPrecision(2));
    const eyeM = Math.max(500 * ringKm, 1.4 * Math.max(max[2], 0));
    return { ring_km: ringKm, radius_km: Number((reachKm * radiusShare).toPrecision(3)), eye_m: Number(eyeM.toPrecision(2)) };
  };
  return { near: preset(1 / 10, 1 / 3), far: preset(1 / 6, 1) };
}

/** A step that divides a range into some hundred parts, with one digit. */
function niceStep(range) {
  return range > 0 ? 10 ** Math.floor(Math.log10(range / 100)) : 1;
}

/** The label's key: map.alpha is alpha. */
export const labelOf = (key) => key.split('.').at(-1);

/** A setting by its place. */
export const valueAt = (settings, key) => key.split('.').reduce((value, part) => value?.[part], settings);

/** The change that sets one. */
export function changeOf(key, value) {
  const [first, second] = key.split('.');
  return second ? { [first]: { [second]: value } } : { [first]: value };
}
