// The controls themselves: sliders with a number beside, choices, switches. Each has show(settings) and gives changes by a call.

import { changeOf, labelOf, valueAt } from './controls.js';
import { number } from './format.js';
import { t } from './i18n.js';

/** Places of a slider. */
const PLACES = 1000;
let count = 0;

/** An element with properties and children. */
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** Text that follows the language. */
export function worded(tag, key, properties = {}) {
  const element = make(tag, { textContent: t(key), ...properties });
  element.dataset.t = key;
  return element;
}

/** A row of the panel; `change` hears what it sets. */
export function widget(row, change) {
  const made = row.presets ? presets(row, change) : row.flag ? flag(row, change) : row.choices ? choices(row, change) : slider(row, change);
  const show = (settings) => {
    made.element.hidden = row.when ? !row.when(settings) : false;
    if (!made.element.hidden) made.show?.(settings);
  };
  return { element: made.element, show };
}

function slider(row, change) {
  const id = `c${(count += 1)}`;
  const scale = scaleOf(row);
  const range = make('input', { type: 'range', min: 0, max: PLACES, step: 1, id: `${id}r` });
  const field = make('input', { type: 'number', id, min: row.zero ? 0 : row.least, step: 'any', inputMode: 'decimal' });
  const label = worded('label', labelOf(row.key), { htmlFor: id });
  const unit = make('span', { className: 'unit', textContent: row.unit ?? '' });
  const head = make('div', { className: 'head' }, label, field, unit);
  const canBeOff = row.none !== undefined;
  const off = canBeOff ? make('input', { type: 'checkbox', id: `${id}o` }) : null;
  if (off) {
    head.prepend(off);
    label.htmlFor = `${id}o`;
    off.addEventListener('change', () => change(changeOf(row.key, off.checked ? tidy(row, row.none) : null)));
  }
  field.setAttribute('aria-label', t(labelOf(row.key)));
  range.addEventListener('input', () => change(changeOf(row.key, tidy(row, scale.value(range.valueAsNumber)))));
  field.addEventListener('change', () => {
    const value = field.valueAsNumber;
    if (Number.isFinite(value)) change(changeOf(row.key, row.whole ? Math.round(value) : value));
  });
  const show = (settings) => {
    const value = valueAt(settings, row.key) ?? null;
    const isOff = value === null;
    if (off) off.checked = !isOff;
    range.disabled = field.disabled = isOff;
    const words = t(labelOf(row.key));
    range.setAttribute('aria-label', words);
    field.setAttribute('aria-label', words);
    if (isOff) return;
    if (document.activeElement !== field) field.value = String(tidy(row, value));
    range.value = String(scale.place(value));
    range.setAttribute('aria-valuetext', `${number(value, 3)} ${row.unit ?? ''}`.trim());
    range.style.setProperty('--share', `${(100 * range.valueAsNumber) / PLACES}%`);
  };
  return { element: make('div', { className: 'row slider' }, head, range), show };
}

/** Between values and places of the slider. */
function scaleOf({ least, most, log, zero }) {
  const clamp = (share) => Math.round(PLACES * Math.max(0, Math.min(1, share)));
  if (!log) return { value: (place) => least + ((most - least) * place) / PLACES, place: (value) => clamp((value - least) / (most - least || 1)) };
  const factor = Math.log(most / least);
  return {
    value: (place) => (zero && place === 0 ? 0 : least * Math.exp((factor * place) / PLACES)),
    place: (value) => (value <= 0 ? 0 : clamp(Math.log(value / least) / factor)),
  };
}

/** A value with no more digits than anyone set on purpose. */
function tidy({ step, whole }, value) {
  if (whole) return Number(Math.round(value).toPrecision(3));
  return step ? Number((Math.round(value / step) * step).toFixed(6)) : Number(value.toPrecision(3));
}

function flag(row, change) {
  const id = `c${(count += 1)}`;
  const box = make('input', { type: 'checkbox', id });
  box.addEventListener('change', () => change(changeOf(row.key, box.checked)));
  const element = make('div', { className: 'row flag' }, box, worded('label', labelOf(row.key), { htmlFor: id }));
  return { element, show: (settings) => (box.checked = Boolean(valueAt(settings, row.key))) };
}

function choices(row, change) {
  const name = labelOf(row.key);
  const group = `c${(count += 1)}`;
  const legend = worded('legend', name);
  const inputs = row.choices.map((value) => {
    const input = make('input', { type: 'radio', name: group, value });
    input.addEventListener('change', () => change(changeOf(row.key, value)));
    return input;
  });
  const labels = inputs.map((input) => make('label', {}, input, worded('span', `${name}_${input.value}`)));
  const element = make('fieldset', { className: 'row choices' }, legend, make('div', { className: 'chips' }, ...labels));
  const show = (settings) => inputs.forEach((input) => (input.checked = input.value === valueAt(settings, row.key)));
  return { element, show };
}

function presets(row, change) {
  const buttons = Object.entries(row.presets).map(([name, numbers]) => {
    const button = worded('button', name, { type: 'button', className: 'small' });
    button.addEventListener('click', () => change({ map: numbers }));
    return button;
  });
  const element = make('div', { className: 'row presets' }, worded('span', 'presets'), ...buttons);
  return { element };
}
