// Streaming: asks the viewer which ranges it wants, fetches them, hands them over; lives through lost connections.

import { SourceError } from './source.js';

/** First bytes fetched: most heads are shorter. */
const FIRST_BYTES = 262_144;
const MOST_IN_FLIGHT = 6;
/** Pause after the first failure, and the longest one. */
const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 8_000;

/** Begins to fetch the first bytes, while the viewer is still being made. */
export function beginReading(source) {
  const bytes = source.read(0, FIRST_BYTES);
  // a failure is told when they are needed
  bytes.catch(() => {});
  return bytes;
}

/** The first bytes of a surface (`begun`, where they are on their way), until the viewer has its whole head; the facts in them. */
export async function openSurface(source, viewer, onLost, begun = null) {
  let need = FIRST_BYTES;
  for (;;) {
    const start = await patiently(() => {
      const bytes = begun ?? source.read(0, need);
      begun = null;
      return bytes;
    }, onLost);
    const facts = JSON.parse(viewer.open(start));
    if (!facts.need) return facts;
    if (start.length >= facts.need || facts.need <= need) throw new Error('the file is cut short');
    need = facts.need;
  }
}

/** Tries again, less and less often, while the connection is lost. */
async function patiently(read, onLost) {
  let pauseMs = FIRST_PAUSE_MS;
  for (;;) {
    try {
      const bytes = await read();
      onLost(false);
      return bytes;
    } catch (error) {
      if (error.kind !== 'lost') throw error;
      onLost(true);
      await sleep(pauseMs);
      pauseMs = Math.min(2 * pauseMs, LONGEST_PAUSE_MS);
    }
  }
}

/** A pause that ends early when the browser is online again. */
function sleep(pauseMs) {
  return new Promise((resolve) => {
    const end = () => {
      clearTimeout(timer);
      removeEventListener('online', end);
      resolve();
    };
    const timer = setTimeout(end, pauseMs);
    addEventListener('online', end);
  });
}

export class Stream {
  #source;
  #viewer;
  #tell;
  #flying = 0;
  #lost = false;
  #over = false;
  #pauseMs = FIRST_PAUSE_MS;

  /** `tell(what, detail)` hears of 'arrived', 'lost', 'back', 'damaged', 'changed', 'missing'. */
  constructor(source, viewer, tell) {
    this.#source = source;
    this.#viewer = viewer;
    this.#tell = tell;
  }

  get inFlight() {
    return this.#flying;
  }

  get isLost() {
    return this.#lost;
  }

  /** Begins to fetch what is wanted now. */
  pump() {
    if (this.#over || this.#lost) return;
    this.#ask(MOST_IN_FLIGHT);
  }

  /** Fetches no more: another surface or viewer takes over. */
  stop() {
    this.#over = true;
  }

  #ask(most) {
    const wanted = this.#wanted(most);
    for (let i = 0; i + 2 < wanted.length; i += 3) this.#fetch(wanted[i], wanted[i + 1], wanted[i + 2]);
    return wanted.length > 0;
  }

  /** The viewer may find damage in what it has as well. */
  #wanted(most) {
    try {
      return this.#viewer.requests(most);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw error;
      this.#tell('damaged', error.message ?? String(error));
      return [];
    }
  }

  async #fetch(id, offset, length) {
    this.#flying += 1;
    let bytes = null;
    let error = null;
    try {
      bytes = await this.#source.read(offset, length);
    } catch (caught) {
      error = caught instanceof SourceError ? caught : new SourceError('lost', String(caught));
    }
    this.#flying -= 1;
    if (this.#over) return;
    if (error) this.#fail(id, error);
    else this.#arrive(id, bytes);
  }

  #arrive(id, bytes) {
    if (this.#lost) {
      this.#lost = false;
      this.#pauseMs = FIRST_PAUSE_MS;
      this.#tell('back');
    }
    try {
      this.#viewer.receive(id, bytes);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw error;
      this.#tell('damaged', error.message ?? String(error));
    }
    this.#tell('arrived');
    this.pump();
  }

  #fail(id, error) {
    this.#viewer.failed(id);
    if (error.kind !== 'lost') {
      this.#over = true;
      this.#tell(error.kind, error.message);
    } else if (!this.#lost) {
      this.#lost = true;
      this.#tell('lost', error.message);
      this.#probe();
    }
  }

  /** While the connection is lost, one request at a time tells when it is back. */
  async #probe() {
    while (this.#lost && !this.#over) {
      await sleep(this.#pauseMs);
      this.#pauseMs = Math.min(2 * this.#pauseMs, LONGEST_PAUSE_MS);
      if (this.#flying > 0 || !this.#lost || this.#over) continue;
      if (this.#ask(1)) continue;
      // nothing is wanted any more: there is no way to know, and no need
      this.#lost = false;
      this.#tell('back');
    }
  }
}
