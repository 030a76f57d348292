// One surface in one viewer: opened, streamed, drawn, and made anew at the same view when the graphics device is lost.

import * as format from './format.js';
import { t } from './i18n.js';
import { Loop, makeViewer } from './loop.js';
import { alarm, say, unsay } from './messages.js';
import { Source } from './source.js';
import { Stream, beginReading, openSurface } from './stream.js';

/** A viewer on a surface, and everything that feeds it. */
export class Session {
  viewer = null;
  canvas = null;
  facts = null;
  settings = {};
  /** The settings of a surface just opened: links tell what differs. */
  usual = {};
  progress = null;
  #hooks;
  #stage;
  #stream = null;
  #loop = null;
  #view = null;
  /** Settings and view that were asked for, until there is something to apply them to. */
  #pending = null;
  #damage = null;
  #isFirst = true;
  #isClosed = false;
  #again = true;

  /** Hooks: before(dtS), after(again), arrived(), shown(refused) when the first picture stands, unreadable(why), lost(settings, view). */
  constructor(stage, surface, backend, memoryBytes, hooks) {
    Object.assign(this, { surface, backend, memoryBytes });
    this.#stage = stage;
    this.#hooks = hooks;
  }

  /** Opens the surface; settings and a view come into force with the first picture. */
  async open(settings = {}, view = null) {
    const source = new Source(this.surface.pack);
    source.onWhole = (size) => say(t('whole', { size: size ? format.bytes(size) : '?' }), { kind: 'whole' });
    const begun = beginReading(source);
    const { canvas, viewer } = await makeViewer(this.#stage, this.backend);
    if (this.#isClosed) return viewer.free();
    Object.assign(this, { canvas, viewer });
    const facts = await openSurface(source, viewer, (isLost) => this.#showLost(isLost), begun);
    if (this.#isClosed) return;
    this.facts = facts;
    viewer.set_memory(this.memoryBytes);
    this.usual = JSON.parse(viewer.settings('{}'));
    this.settings = this.usual;
    this.#pending = { settings, view };
    this.#stream = new Stream(source, viewer, (what, detail) => this.#hear(what, detail));
    this.#loop = new Loop(this.#stage, canvas, viewer, {
      before: (dtS) => this.#hooks.before(dtS),
      after: (again) => this.#after(again),
      failed: (error) => this.#failed(error),
    });
    this.wake();
  }

  /** Follows another link to the same surface. */
  follow(settings, view) {
    this.#pending = { settings: { ...this.usual, ...settings, map: { ...this.usual.map, ...settings.map } }, view };
    this.wake();
  }

  /** Whether what was asked for is not in force yet. */
  get isPending() {
    return this.#pending !== null;
  }

  wake() {
    this.#again = true;
    this.#loop?.wake();
  }

  drawNow() {
    this.#loop.drawNow();
  }

  /** Whether the picture is what it should be and nothing moves. */
  get isAtRest() {
    return this.#pending === null && !this.#again && this.progress?.is_complete === true && this.#stream.inFlight === 0;
  }

  /** Changes settings; says why when the viewer refuses. */
  change(settings) {
    try {
      this.settings = JSON.parse(this.viewer.settings(JSON.stringify(settings)));
    } catch (error) {
      say(t('refused', { why: error.message }), { kind: 'refused' });
    }
    this.wake();
    return this.settings;
  }

  /** The settings as they are: gestures change some. */
  refresh() {
    this.settings = JSON.parse(this.viewer.settings('{}'));
    return this.settings;
  }

  /** The view, also while it waits for data. */
  view() {
    return this.#pending?.view ?? this.viewer.view();
  }

  setMemory(bytes) {
    this.memoryBytes = bytes;
    this.viewer.set_memory(bytes);
    this.wake();
  }

  close() {
    this.#isClosed = true;
    this.#stream?.stop();
    this.#loop?.stop();
    try {
      this.viewer?.free();
    } catch {
      // a viewer that has panicked cannot be freed, and need not be
    }
    this.viewer = null;
  }

  /** Settings from a link, one by one, so that one refused takes no other with it. */
  #applyEach(settings) {
    const refused = [];
    const { mode, map, ...others } = settings;
    const changes = Object.entries(others).map(([key, value]) => ({ [key]: value }));
    if (map) changes.push({ map });
    if (mode !== undefined) changes.push({ mode });
    for (const change of changes) {
      try {
        this.settings = JSON.parse(this.viewer.settings(JSON.stringify(change)));
      } catch (error) {
        refused.push(error.message);
      }
    }
    return refused;
  }

  /** Applies what was asked for as soon as there is a surface to stand over. */
  #applyPending() {
    if (this.#pending === null) return;
    if (JSON.parse(this.viewer.view()).eye === undefined) {
      if (this.#damage && this.#stream.inFlight === 0) this.#hooks.unreadable(this.#damage);
      return;
    }
    const { settings, view } = this.#pending;
    this.#pending = null;
    if (this.#isFirst) this.usual = this.refresh();
    this.#isFirst = false;
    const refused = this.#applyEach(settings);
    try {
      if (view) this.viewer.set_view(view);
    } catch (error) {
      refused.push(error.message);
    }
    this.refresh();
    this.wake();
    this.#hooks.shown(refused);
    if (this.#damage) this.#showDamage(this.#damage);
  }

  #after(again) {
    this.#again = again;
    this.#stream.pump();
    this.#applyPending();
    if (!this.viewer) return;
    this.progress = JSON.parse(this.viewer.progress());
    this.#view = this.view();
    this.#hooks.after(again);
  }

  #hear(what, detail) {
    if (what === 'arrived') this.#hooks.arrived();
    else if (what === 'damaged') this.#showDamage(detail);
    else if (what === 'lost' || what === 'back') this.#showLost(what === 'lost');
    else this.#over(what, detail);
    this.wake();
  }

  #showDamage(why) {
    this.#damage = why;
    if (this.#pending === null) say(t('damaged', { why }), { kind: 'damaged' });
  }

  #showLost(isLost) {
    const wasLost = document.querySelector('#messages [data-kind=lost]') !== null;
    if (isLost && !wasLost) say(t('lost'), { kind: 'lost', stays: true });
    if (isLost || !wasLost) return;
    unsay('lost');
    say(t('back'), { kind: 'back' });
  }

  /** The server has nothing more for this viewer; what is here stays on the screen. */
  #over(what, detail) {
    unsay('lost');
    alarm(what === 'changed' ? t('changed') : t('missing', { why: detail }), 'reload', () => location.reload());
  }

  #failed(error) {
    this.#stream.stop();
    const why = error.message ?? String(error);
    const words = /^device lost/i.test(why) ? t('gpu_lost') : t('broken', { why });
    const { settings } = this;
    const view = this.#view;
    alarm(words, 'again', () => this.#hooks.lost(settings, view));
  }
}
