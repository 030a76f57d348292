// A file on a web server, read by ranges: knows whether it is still the same file, and whether the server can do it at all.

/** A server that cannot send parts may send a whole file up to this. */
export const MOST_WHOLE_BYTES = 64 * 2 ** 20;
/** A connection that is silent for so long is taken for lost. */
const SILENCE_MS = 20_000;

/** What went wrong. `kind`: 'lost' (worth trying again), 'changed' (another file is there now), 'missing' (no use trying), 'whole' (no ranges, too large). */
export class SourceError extends Error {
  constructor(kind, message) {
    super(message);
    this.kind = kind;
  }
}

export class Source {
  #url;
  #mark = null;
  #whole = null;
  /** Bytes of the file, once known. */
  bytes = null;
  /** Called with its size when the server sends the whole file instead of a part. */
  onWhole = () => {};

  constructor(url) {
    this.#url = url;
  }

  /** `length` bytes from `offset`; fewer only at the end of the file. */
  async read(offset, length) {
    if (this.#whole) return this.#whole.slice(offset, offset + length);
    const silence = new Silence();
    try {
      const headers = { Range: `bytes=${offset}-${offset + length - 1}` };
      const response = await fetch(this.#url, { headers, signal: silence.signal });
      silence.heard();
      if (response.status === 206) return await this.#part(response, offset, length, silence);
      if (response.status === 200) return await this.#all(response, offset, length, silence);
      response.body?.cancel().catch(() => {});
      throw refusal(response, this.#mark !== null);
    } catch (error) {
      if (error instanceof SourceError) throw error;
      throw new SourceError('lost', error?.message ?? String(error));
    } finally {
      silence.end();
    }
  }

  async #part(response, offset, length, silence) {
    const said = /^bytes (\d+)-(\d+)\/(\d+|\*)$/.exec(response.headers.get('Content-Range') ?? '');
    if (!said || Number(said[1]) !== offset) throw new SourceError('missing', 'the server sent another part than it was asked for');
    const total = said[3] === '*' ? null : Number(said[3]);
    this.#recognise(response, total);
    const expected = Math.min(length, Number(said[2]) - offset + 1);
    const bytes = await readAll(response, expected, silence);
    if (bytes.length !== expected) throw new SourceError('lost', `${bytes.length} of ${expected} bytes arrived`);
    return bytes;
  }

  async #all(response, offset, length, silence) {
    const total = Number(response.headers.get('Content-Length')) || null;
    if (this.#mark !== null) {
      response.body?.cancel().catch(() => {});
      throw new SourceError('changed', 'the server no longer sends parts');
    }
    if (total > MOST_WHOLE_BYTES) {
      response.body?.cancel().catch(() => {});
      throw new SourceError('whole', String(total));
    }
    this.onWhole(total);
    const bytes = await readAll(response, MOST_WHOLE_BYTES + 1, silence);
    if (bytes.length > MOST_WHOLE_BYTES) throw new SourceError('whole', `> ${MOST_WHOLE_BYTES}`);
    this.#whole = bytes;
    this.bytes = bytes.length;
    return bytes.slice(offset, offset + length);
  }

  /** Notes what marks this file, or finds that another one is there now. */
  #recognise(response, total) {
    const tag = (response.headers.get('ETag') ?? response.headers.get('Last-Modified') ?? '').replace(/^W\//, '');
    const mark = `${total} ${tag}`;
    this.bytes ??= total;
    this.#mark ??= mark;
    if (mark === this.#mark) return;
    response.body?.cancel().catch(() => {});
    throw new SourceError('changed', 'another file is there now');
  }
}

/** A refused request as an error. */
function refusal(response, wasThere) {
  const said = `${response.status} ${response.statusText}`.trim();
  if (response.status >= 500 || response.status === 429 || response.status === 408) return new SourceError('lost', said);
  const isOther = response.status === 416 || response.status === 412;
  return new SourceError(isOther && wasThere ? 'changed' : 'missing', said);
}

/** The body, at most `most` bytes of it. */
async function readAll(response, most, silence) {
  const reader = response.body.getReader();
  const parts = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    silence.heard();
    if (done) break;
    parts.push(value);
    length += value.length;
    if (length >= most) {
      if (length > most) reader.cancel().catch(() => {});
      break;
    }
  }
  const bytes = new Uint8Array(Math.min(length, most));
  let at = 0;
  for (const part of parts) {
    bytes.set(part.subarray(0, bytes.length - at), at);
    at += part.length;
    if (at >= bytes.length) break;
  }
  return bytes;
}

/** Ends a request that has gone silent. */
class Silence {
  #controller = new AbortController();
  #timer = 0;
  signal = this.#controller.signal;

  constructor() {
    this.heard();
  }

  heard() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#controller.abort(), SILENCE_MS);
  }

  end() {
    clearTimeout(this.#timer);
  }
}
