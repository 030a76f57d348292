// Parts of the page that need no browser: node --test web_tests/units.mjs

import assert from 'node:assert/strict';
import { it } from 'node:test';

const page = '../crates/yamanami_web/page/';
const { encode, decode } = await import(`${page}rison.js`);
const { readHash, writeHash } = await import(`${page}hash.js`);
const { ticks } = await import(`${page}plot.js`);
const { Source, SourceError } = await import(`${page}source.js`);
const { en } = await import(`${page}words_en.js`);
const { ja } = await import(`${page}words_ja.js`);

it('values survive becoming part of an address', () => {
  const value = { eye: [1.5, -2e-7, 3], map: { lon: 138.7, up_deg: null, on: true, off: false }, words: ["it's !x", 'a b', ''], none: [], empty: {} };
  assert.deepEqual(decode(encode(value)), value);
  for (const nonsense of ['', '(', '(a)', '(a:1', '!(1,', "'x", '1x', '!x', '('.repeat(50)]) assert.equal(decode(nonsense), undefined, nonsense);
});

it('links hold what differs, and nonsense in them is told', () => {
  const usual = { mode: 'relief', budget: 1000, colour: 'height', map: { alpha: 0 } };
  const settings = { ...usual, budget: null, map: { alpha: 0.25 } };
  const hash = writeHash({ surface: 'a b', language: 'ja', gpu: 'auto', view: '{"eye":[1,2,3]}', settings, usual });
  const link = readHash(hash);
  assert.deepEqual(link.settings, { budget: null, map: { alpha: 0.25 } });
  assert.deepEqual([link.surface, link.language, JSON.parse(link.view), link.ignored], ['a b', 'ja', { eye: [1, 2, 3] }, []]);
  const bad = readHash('#a=9&b=-1&c=Pink!&m=globe&v=3&l=xx&gpu=cuda&q=1&=&s=%E0%A4%A&constructor=1');
  assert.deepEqual([bad.settings, bad.view, bad.surface], [{}, null, null]);
  assert.equal(bad.ignored.length, 11);
});

it('axes have round numbers', () => {
  assert.deepEqual(ticks(0, 10, 5), [0, 2, 4, 6, 8, 10]);
  assert.deepEqual(ticks(995, 1032, 3), [1000, 1020]);
  assert.ok(ticks(0, 1e-9, 4).length < 50 && ticks(5, 5, 4).length <= 50);
});

it('every word is there in both languages', () => {
  assert.deepEqual(Object.keys(en).filter((key) => !(key in ja)), []);
  assert.deepEqual(Object.keys(ja).filter((key) => !(key in en)), []);
  const names = (words) => (words.match(/\{\w+\}/g) ?? []).sort().join();
  for (const key of Object.keys(en)) assert.equal(names(ja[key]), names(en[key]), key);
});

it('a source knows its file from another, and tells what went wrong', async () => {
  const answer = (status, headers, body = 'abcd') => new Response(status === 204 ? null : body, { status, headers });
  const part = (etag, range = 'bytes 0-3/10', body = 'abcd') => answer(206, { ETag: etag, 'Content-Range': range }, body);
  const kindOf = async (...answers) => {
    const source = new Source('x');
    try {
      for (const each of answers) {
        globalThis.fetch = async () => each();
        await source.read(0, 4);
      }
      return 'fine';
    } catch (error) {
      assert.ok(error instanceof SourceError);
      return error.kind;
    }
  };
  assert.equal(await kindOf(() => part('"a"'), () => part('"a"')), 'fine');
  assert.equal(await kindOf(() => part('"a"'), () => part('"b"')), 'changed');
  assert.equal(await kindOf(() => part('"a"'), () => part('"a"', 'bytes 0-3/11')), 'changed');
  assert.equal(await kindOf(() => part('"a"'), () => answer(416, {})), 'changed');
  assert.equal(await kindOf(() => part('"a"'), () => answer(200, {})), 'changed');
  assert.equal(await kindOf(() => part('"a"', 'bytes 4-7/10')), 'missing');
  assert.equal(await kindOf(() => part('"a"', 'bytes 0-3/10', 'ab')), 'lost');
  assert.equal(await kindOf(() => answer(404, {})), 'missing');
  assert.equal(await kindOf(() => answer(503, {})), 'lost');
  assert.equal(await kindOf(() => answer(200, { 'Content-Length': '100000000' })), 'whole');
  assert.equal(await kindOf(() => answer(200, {})), 'fine');
  assert.equal(await kindOf(() => { throw new TypeError('no net'); }), 'lost');
});
