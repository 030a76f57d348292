// What the tests of the viewer run on: the program, small surfaces made by it, a server of it, a static site, and helpers.

import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { cp, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

export const ROOT = dirname(dirname(fileURLToPath(import.meta.url)));
export const PROGRAM = process.env.YAMANAMI ?? join(ROOT, 'target/debug/yamanami');
export const WEB = process.env.YAMANAMI_WEB ?? join(ROOT, 'target/web');
/** Pictures of the pages are kept here, to be looked at. */
export const PICTURES = process.env.PICTURES ?? join(ROOT, 'target/web-pictures');

export function run(...words) {
  return execFileSync(PROGRAM, words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 64 * 2 ** 20 });
}

/** A folder with a terrain (UTM zone 54N) and the scan of a pagoda, as databases; removed by `remove`. */
export function makeData() {
  for (const needed of [PROGRAM, join(WEB, 'yamanami_web_bg.wasm')]) if (!existsSync(needed)) throw new Error(`${needed} is missing: scripts/web-test makes it`);
  mkdirSync(PICTURES, { recursive: true });
  const folder = mkdtempSync(join(tmpdir(), 'yamanami-web-'));
  const file = (name) => join(folder, name);
  run('generate', 'fractal', '-o', file('hills.tif'), '--size', '769x641', '--spacing', '30', '--relief', '1500', '--seed', '5');
  run('build', file('hills.tif'), '-o', file('hills.yama'), '--crs', '32654');
  run('generate', 'pagoda', '-o', file('pagoda.ply'), '--faces', '8000');
  run('build', file('pagoda.ply'), '-o', file('pagoda.yama'));
  return { folder, file, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

/** `yamanami serve` of databases on a port (0: any). */
export async function serveProgram(databases, port = 0) {
  const words = ['serve', ...databases, '--listen', `127.0.0.1:${port}`, '--no-open', '--web', WEB];
  const child = spawn(PROGRAM, words, { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  child.stderr.on('data', (text) => (said += text));
  const url = await new Promise((resolve, reject) => {
    createInterface({ input: child.stdout }).on('line', (line) => {
      const found = /http:\/\/\S+/.exec(line)?.[0];
      if (found) resolve(found.replace(/\/$/, ''));
    });
    child.once('exit', () => reject(new Error(`serve ended: ${said}`)));
  });
  const ended = new Promise((resolve) => child.once('exit', resolve));
  const stop = (signal = 'SIGTERM') => {
    child.kill(signal);
    return ended;
  };
  return { url, port: Number(new URL(url).port), stop };
}

/** A static site of what a server serves, in a folder. */
export async function makeSite(folder, server, names) {
  await cp(WEB, folder, { recursive: true });
  const surfaces = [];
  for (const name of names) {
    const response = await fetch(`${server.url}/s/${name}/surface.pack`);
    if (!response.ok) throw new Error(`surface.pack of ${name}: ${response.status}`);
    await writeFile(join(folder, `${name}.pack`), Buffer.from(await response.arrayBuffer()));
    surfaces.push({ name, title: name, pack: `${name}.pack`, picture: null, credit: 'made for a test' });
  }
  writeFileSync(join(folder, 'site.json'), JSON.stringify({ surfaces }));
}

/** Waits until the picture is what it should be and nothing moves. */
export async function atRest(page) {
  await page.waitForFunction(() => window.yamanami?.isAtRest, null, { polling: 50 });
}

/** Opens a page of the viewer and waits for its picture. */
export async function open(page, address) {
  await page.goto(address);
  await page.evaluate(() => window.yamanami.ready);
  await atRest(page);
}

/** The canvas as PNG, without what lies on it. */
export async function canvasPng(page) {
  const data = await page.evaluate(() => {
    const { session } = window.yamanami.page;
    session.refresh();
    session.drawNow();
    return session.canvas.toDataURL('image/png');
  });
  return Buffer.from(data.slice(data.indexOf(',') + 1), 'base64');
}

/** How alike two pictures in files are, by the program: { ssim, flip, mean_difference }. */
export function compare(a, b) {
  return JSON.parse(run('compare', a, b, '--json'));
}

/** Number of different colours of the canvas, up to a thousand: a blank one has one. */
export function colours(page) {
  return page.evaluate(() => {
    const { session } = window.yamanami.page;
    session.refresh();
    session.drawNow();
    const { width, height } = session.canvas;
    const copy = Object.assign(document.createElement('canvas'), { width, height });
    const pen = copy.getContext('2d');
    pen.drawImage(session.canvas, 0, 0);
    const pixels = new Uint32Array(pen.getImageData(0, 0, width, height).data.buffer);
    return Math.min(1000, new Set(pixels).size);
  });
}
