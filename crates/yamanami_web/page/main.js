// The page: puts its parts together.

import { hearDrops } from './drop.js';
import * as format from './format.js';
import { toggleFull } from './full.js';
import { readHash } from './hash.js';
import { toggleHelp } from './help.js';
import { currentLanguage, LANGUAGES, onLanguage, setLanguage, t, usualLanguage } from './i18n.js';
import { listen } from './input.js';
import { driveMap, Keys } from './keys.js';
import { Layers } from './layers.js';
import { Link } from './link.js';
import { Marks } from './marks.js';
import { block, say } from './messages.js';
import { Panel } from './panel.js';
import { pick, Picking } from './picking.js';
import { Profile } from './profile.js';
import { savePicture } from './screenshot.js';
import { Session } from './session.js';
import { readSite } from './site.js';
import { showProgress, showStats } from './status.js';
import { Tools } from './tools.js';

const MEMORY_BYTES = (navigator.deviceMemory ?? 4) < 4 ? 256 * 2 ** 20 : 512 * 2 ** 20;
const ZOOM_STEP = 0.7;
class Page {
  stage = document.getElementById('stage');
  surfaces = [];
  session = null;
  drag = { moves: false };

  constructor() {
    this.panel = new Panel({
      change: (change) => this.change(change),
      surface: (name) => this.#open({ ...readHash(''), surface: name }),
      files: (list) => this.addFiles(list),
      removeFile: (file) => this.removeFile(file),
      memory: (bytes) => this.session?.setMemory(bytes),
    });
    this.tools = new Tools((name) => this.act(name));
    this.picking = new Picking();
    this.layers = new Layers();
    this.marks = new Marks(document.getElementById('marks'));
    this.profile = new Profile(() => this.drawMarks(), () => this.act('profile'));
    this.keys = new Keys(this.stage, (name) => this.act(name), () => this.wake());
    listen(this.stage, this, this.drag);
    addEventListener('hashchange', () => this.follow());
    hearDrops((list) => this.addFiles(list));
    const button = document.getElementById('language');
    button.addEventListener('click', () => setLanguage(LANGUAGES[(LANGUAGES.indexOf(currentLanguage()) + 1) % LANGUAGES.length]));
    onLanguage(() => {
      button.textContent = t('other_language');
      this.tools.showDrag(this.drag.moves);
      this.#told();
    });
  }

  get viewer() {
    return this.session?.facts ? this.session.viewer : null;
  }

  isMap() {
    return this.session?.settings.mode === 'map';
  }

  wake() {
    this.session?.wake();
  }

  /** Reads the list of surfaces and shows the one that the link names. */
  async start() {
    const link = readHash(location.hash);
    this.gpu = link.gpu;
    this.link = new Link(link);
    setLanguage(link.language ?? usualLanguage());
    try {
      this.surfaces = await readSite(new URL('site.json', location.href).href);
    } catch (error) {
      return block(t('no_site'), error.message);
    }
    if (this.surfaces.length === 0) block(t('no_surfaces'));
    else await this.#open(link);
  }

  /** Follows a link that was changed by hand or by going back. */
  async follow() {
    const link = readHash(location.hash);
    if (link.language) setLanguage(link.language);
    await this.#open(link);
  }

  async #open(link) {
    const surface = this.surfaces.find(({ name }) => name === link.surface) ?? this.surfaces[0];
    if (link.surface && surface.name !== link.surface) say(t('no_such_surface', { name: link.surface.slice(0, 60), other: surface.title }), { kind: 'surface' });
    if (link.ignored.length) say(t('link_ignored', { parts: link.ignored.join(', ') }), { kind: 'link' });
    if (this.viewer && this.session.surface === surface) this.session.follow(link.settings, link.view);
    else await this.#begin(surface, link.settings, link.view);
  }

  async #begin(surface, settings, view) {
    const old = this.session;
    old?.close();
    document.querySelector('.blocked')?.remove();
    document.getElementById('alarm').hidden = true;
    const session = new Session(this.stage, surface, this.gpu, old?.memoryBytes ?? MEMORY_BYTES, {
      before: (dtS) => this.#before(dtS),
      after: (again) => this.#after(again),
      arrived: () => this.layers.stale(),
      shown: (refused) => this.#shown(refused),
      unreadable: (why) => this.#refuse(new Error(why)),
      lost: (lastSettings, lastView) => this.#begin(surface, lastSettings, lastView),
    });
    this.session = session;
    document.getElementById('title').textContent = surface.title;
    document.title = `${surface.title} – yamanami`;
    document.getElementById('credit').textContent = surface.credit;
    showProgress(null);
    try {
      await session.open(settings, view);
    } catch (error) {
      if (this.session === session) this.#refuse(error);
      return;
    }
    if (this.session === session) this.#opened(session, old?.surface === surface);
  }

  #opened(session, isSame) {
    const { facts, surface, viewer } = session;
    this.panel.build({ facts, surfaces: this.surfaces, current: surface.name, device: viewer.device(), memoryBytes: session.memoryBytes });
    this.picking.open(facts);
    this.layers.open(viewer, facts);
    if (isSame && this.profile.isOn) this.profile.takeOver(viewer);
    else this.profile.open(viewer, surface);
    this.marks.tapped = null;
    this.tools.offer('map', facts.can_map);
    this.tools.offer('profile', facts.kind !== 'model');
    this.#told();
  }

  /** The surface stands there: what the link asked for is in force. */
  #shown(refused) {
    window.yamanami.firstPictureMs ??= performance.now();
    if (refused.length) say(t('link_ignored', { parts: refused.join('; ') }), { kind: 'link' });
    this.#told();
  }

  #refuse(error) {
    const why = error.message ?? String(error);
    if (!this.session.viewer) block(t('blocked_gpu'), why);
    else if (error.kind === 'whole') block(t('no_ranges', { size: format.bytes(Number(why)) }));
    else if (error.kind === 'missing') block(t('missing', { why }));
    else block(t('unreadable', { why }));
    this.session.close();
  }

  /** Settings were changed, by whatever: everything shows them. */
  #told() {
    const session = this.session;
    if (!session?.facts) return;
    this.panel.show(session.settings);
    this.tools.press('map', this.isMap());
    this.tools.press('fly', this.viewer?.is_fly() ?? false);
    this.tools.enable('fly', !this.isMap());
    this.link.follow(this.session);
  }

  change(change) {
    this.session?.change(change);
    this.#told();
  }

  /** What a button or a key asks for. */
  act(name) {
    const viewer = this.viewer;
    if (name === 'help') toggleHelp();
    if (!viewer) return;
    const { settings, facts, canvas } = this.session;
    const middle = [canvas.width / 2, canvas.height / 2];
    const acts = {
      home: () => viewer.home(),
      nearer: () => viewer.zoom(ZOOM_STEP, ...middle),
      farther: () => viewer.zoom(1 / ZOOM_STEP, ...middle),
      drag: () => this.tools.showDrag((this.drag.moves = !this.drag.moves)),
      fly: () => viewer.set_fly(!viewer.is_fly() && !this.isMap()),
      map: () => facts.can_map && this.change({ mode: this.isMap() ? 'relief' : 'map' }),
      profile: () => this.#toggleProfile(),
      colour: () => this.change({ colour: facts.colours[(facts.colours.indexOf(settings.colour) + 1) % facts.colours.length] }),
      edges: () => this.change({ wireframe: !settings.wireframe }),
      enter: () => this.click(...middle, 'key'),
      escape: () => (this.profile.isOn ? this.#toggleProfile() : this.#tap(null)),
      picture: () => this.#savePicture(),
      full: () => toggleFull(),
    };
    acts[name]?.();
    this.#told();
    this.wake();
  }

  #toggleProfile() {
    if (this.session.facts.kind === 'model') return;
    this.profile.toggle(!this.profile.isOn);
    this.tools.press('profile', this.profile.isOn);
    this.stage.focus({ preventScroll: true });
    this.drawMarks();
  }

  click(xPx, yPx, pointer) {
    const viewer = this.viewer;
    const found = viewer && pick(viewer, [xPx, yPx]);
    this.picking.ask([xPx, yPx], pointer !== 'mouse');
    if (found && this.profile.isOn) this.profile.add(found);
    this.#tap(found);
    this.wake();
  }

  #tap(found) {
    this.marks.tapped = found?.local ?? null;
    this.drawMarks();
  }

  hover(xPx, yPx) {
    this.picking.ask([xPx, yPx]);
    this.wake();
  }

  leave() {
    if (!this.marks.tapped) this.picking.ask(null);
    this.wake();
  }

  async addFiles(list) {
    if (!this.viewer) return;
    await this.layers.add(list);
    this.panel.showFiles(this.layers.files);
    this.drawMarks();
  }

  removeFile(file) {
    this.layers.remove(file);
    this.panel.showFiles(this.layers.files);
    this.drawMarks();
  }

  drawMarks() {
    if (this.viewer) this.marks.draw(this.viewer, this.layers.files, this.profile.marks());
  }

  #before(dtS) {
    const drive = this.keys.drive();
    if (drive && this.isMap()) driveMap(this.session, drive, dtS);
    else if (drive) this.viewer.drive(drive.ahead, drive.aside, drive.up, drive.fast, dtS);
    return drive !== null;
  }

  #after(again) {
    const { viewer, progress } = this.session;
    const nowMs = performance.now();
    this.picking.update(viewer, again);
    this.layers.update(nowMs);
    const isReading = this.profile.update(nowMs);
    this.drawMarks();
    showProgress(progress);
    showStats(viewer, nowMs, !again);
    this.panel.showProgress(progress);
    if (!again) this.panel.show(this.session.refresh());
    this.link.follow(this.session);
    if (isReading) setTimeout(() => this.wake(), 200);
  }

  async #savePicture() {
    const { surface, canvas } = this.session;
    const draw = () => {
      this.session.refresh();
      this.session.drawNow();
      this.drawMarks();
    };
    try {
      await savePicture({ canvas, marks: document.getElementById('marks'), draw, title: surface.title, credit: surface.credit }, surface.name);
      say(t('picture_saved'), { kind: 'picture' });
    } catch (error) {
      say(t('picture_failed', { why: error.message }), { kind: 'picture' });
    }
  }
}

const page = new Page();
const ready = page.start();
/** For tests and the curious. */
window.yamanami = {
  ready,
  page,
  get viewer() { return page.viewer; },
  get isAtRest() { return page.session?.isAtRest ?? false; },
  stats: () => JSON.parse(page.viewer.stats()),
  /** When the first picture stood there, after the page was asked for. */
  firstPictureMs: null,
};
