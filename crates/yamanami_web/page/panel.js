// The panel: which surface, every control, the files laid over it, and what is known of the data.

import { sections } from './controls.js';
import * as format from './format.js';
import { icon } from './icons.js';
import { onLanguage, t, translate } from './i18n.js';
import { make, widget, worded } from './widgets.js';

/** Memory for the surface, MiB: choices of the list. */
const MEMORY_MIB = [64, 128, 256, 512, 1024, 2048];

export class Panel {
  #act;
  #widgets = [];
  #groups = [];
  #facts = null;
  #data = make('dl', { className: 'facts' });
  #files = make('ul', { className: 'files' });
  #overlays = [];
  #progress = null;
  #device = '';

  /** `act` has change(settings), surface(name), files(list), removeFile(file), memory(bytes). */
  constructor(act) {
    this.#act = act;
    onLanguage(() => this.#words());
    const fold = document.getElementById('fold');
    fold.append(icon('fold'));
    fold.addEventListener('click', () => this.fold(fold.getAttribute('aria-expanded') === 'true'));
    if (matchMedia('(max-width: 639px)').matches) this.fold(true);
  }

  fold(isFolded) {
    document.getElementById('panel').classList.toggle('folded', isFolded);
    document.getElementById('fold').setAttribute('aria-expanded', String(!isFolded));
  }

  /** Builds the controls for a surface. */
  build({ facts, surfaces, current, device, memoryBytes }) {
    this.#facts = facts;
    this.#device = device;
    this.#widgets = [];
    this.#groups = [];
    const root = document.getElementById('controls');
    root.replaceChildren();
    if (surfaces.length > 1) root.append(this.#surfaceList(surfaces, current));
    if (facts.can_map) root.append(this.#widget({ key: 'mode', choices: ['relief', 'map'] }));
    for (const section of sections(facts)) root.append(this.#section(section));
    root.append(this.#fileSection(facts), this.#dataSection(memoryBytes));
    this.#words();
  }

  /** Shows what the settings are. */
  show(settings) {
    for (const each of this.#widgets) each.show(settings);
    for (const { element, when } of this.#groups) element.hidden = !when(settings);
  }

  showProgress(progress) {
    this.#progress = progress;
    this.#facts && this.#showData();
  }

  showFiles(overlays) {
    this.#overlays = overlays;
    this.#files.replaceChildren(...overlays.map((file) => {
      const remove = make('button', { type: 'button', className: 'plain', title: t('file_remove', { name: file.name }) }, icon('close'));
      remove.setAttribute('aria-label', remove.title);
      remove.addEventListener('click', () => this.#act.removeFile(file));
      const swatch = make('span', { className: 'swatch' });
      swatch.style.background = file.colour;
      return make('li', {}, swatch, make('span', { textContent: file.title }), remove);
    }));
  }

  #words() {
    if (!this.#facts) return;
    translate(document.getElementById('controls'));
    document.getElementById('facts').textContent = subtitle(this.#facts);
    this.#showData();
    this.showFiles(this.#overlays);
  }

  #widget(row) {
    const made = widget(row, (change) => this.#act.change(change));
    this.#widgets.push(made);
    return made.element;
  }

  #section({ title, open, rows, when }) {
    const element = fold(title, open, ...rows.filter((row) => row.choices?.length !== 0).map((row) => this.#widget(row)));
    if (when) this.#groups.push({ element, when });
    return element;
  }

  #surfaceList(surfaces, current) {
    const items = surfaces.map((surface) => {
      const picture = surface.picture ? make('img', { src: surface.picture, alt: '', loading: 'lazy', width: 72, height: 48 }) : '';
      const button = make('button', { type: 'button' }, picture, make('span', { textContent: surface.title }));
      if (surface.name === current) button.setAttribute('aria-current', 'true');
      button.addEventListener('click', () => this.#act.surface(surface.name));
      return make('li', {}, button);
    });
    return fold('surfaces', true, make('ul', { className: 'surfaces' }, ...items));
  }

  #fileSection(facts) {
    const input = make('input', { type: 'file', multiple: true, accept: '.gpx,.geojson,.json', id: 'file' });
    input.addEventListener('change', () => {
      this.#act.files([...input.files]);
      input.value = '';
    });
    const label = make('label', { className: 'button', htmlFor: 'file' }, icon('file'), worded('span', 'file_choose'));
    const isPlaced = facts.centre_lon_lat !== null && facts.centre_lon_lat !== undefined;
    const section = fold('files', false, input, label, worded('p', 'file_hint', { className: 'hint' }), this.#files);
    section.hidden = !isPlaced;
    return section;
  }

  #dataSection(memoryBytes) {
    const choose = make('select', { id: 'memory' });
    for (const mib of MEMORY_MIB) choose.append(make('option', { value: mib, textContent: `${mib} MiB`, selected: mib * 2 ** 20 === memoryBytes }));
    choose.addEventListener('change', () => this.#act.memory(Number(choose.value) * 2 ** 20));
    const row = make('div', { className: 'row choose' }, worded('label', 'memory', { htmlFor: 'memory' }), choose);
    return fold('data', false, row, this.#data);
  }

  #showData() {
    const facts = this.#facts;
    const rows = [
      ['samples', facts.size && `${format.number(facts.size[0])} × ${format.number(facts.size[1])}`],
      ['step', facts.step_m && format.length(facts.step_m)],
      ['triangles_full', facts.triangles && format.number(facts.triangles)],
      ['coordinates', facts.crs && (facts.epsg ? `${facts.crs} (EPSG:${facts.epsg})` : facts.crs)],
      ['stored_error', facts.max_error_m && `≤ ${format.short(facts.max_error_m)} m`],
      ['file_size', facts.bytes && format.bytes(facts.bytes)],
      ['received', this.#progress && format.bytes(this.#progress.received_bytes)],
      ['resident', this.#progress && format.bytes(this.#progress.resident_bytes)],
      ['device', this.#device],
    ];
    const shown = rows.filter(([, value]) => value).flatMap(([key, value]) => [make('dt', { textContent: t(key) }), make('dd', { textContent: value })]);
    this.#data.replaceChildren(...shown);
  }
}

/** A section that folds. */
function fold(title, open, ...children) {
  return make('details', { open, className: title }, worded('summary', title), make('div', { className: 'inside' }, ...children));
}

/** Extent and heights in a line. */
function subtitle(facts) {
  const { min, max } = facts.bounds;
  const size = [max[0] - min[0], max[1] - min[1]];
  if (facts.kind === 'model') return [...size, max[2] - min[2]].map(format.short).join(' × ');
  const [east, north] = size.map(format.length);
  const extent = east.slice(-2) === north.slice(-2) ? `${east.replace(/ k?m$/, '')} × ${north}` : `${east} × ${north}`;
  return `${extent} · ${format.number(min[2])}–${format.number(max[2])} m`;
}
