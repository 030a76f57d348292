// The viewer in a browser, driven like a reader drives it: node --test web_tests/viewer.mjs

import assert from 'node:assert/strict';
import { existsSync, writeFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { launch, newPage } from './browser.mjs';
import { serveStatic } from './server.mjs';
import { PICTURES, atRest, canvasPng, colours, compare, makeData, makeSite, open, run, serveProgram } from './setup.mjs';

/** Sky, haze and the smoothing of edges differ between graphics interfaces; a wrong mesh or light falls far below. */
const LEAST_SSIM = 0.93;
/** The same of deformed maps, whose backgrounds differ. */
const LEAST_MAP_SSIM = 0.9;

let data, server, site, browser;

before(async () => {
  data = makeData();
  server = await serveProgram([data.file('hills.yama'), data.file('pagoda.yama')]);
  await makeSite(data.file('site'), server, ['hills', 'pagoda']);
  site = await serveStatic({ '/': data.file('site') });
  browser = await launch('webgl2');
});

after(async () => {
  await browser?.close();
  await site?.close();
  await server?.stop();
  data?.remove();
});

/** A page that is closed after the test, and whose console must have been silent. */
async function withPage(options, test) {
  const page = await newPage(browser, options);
  try {
    await test(page);
    assert.deepEqual(page.faults, []);
  } finally {
    await page.context().close();
  }
}

const view = (page) => page.evaluate(() => JSON.parse(window.yamanami.viewer.view()));
/** Waits until the eye is somewhere else. */
const moved = (page, from, by) =>
  page.waitForFunction((eye) => JSON.parse(window.yamanami.viewer.view()).eye.some((value, axis) => Math.abs(value - eye[axis]) > 1), from.eye).catch(() => assert.fail(`${by} moved nothing`));
const stats = (page) => page.evaluate(() => window.yamanami.stats());
const settings = (page) => page.evaluate(() => window.yamanami.page.session.settings);
const change = async (page, change) => {
  await page.evaluate((c) => window.yamanami.page.change(c), change);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  await atRest(page);
};

/** Draws natively what the page shows and says how alike the pictures are. */
async function againstNative(page, name, database) {
  await change(page, { haze: true, morph: false, tolerance_px: 0.5, tolerance_m: 0, budget: null });
  const png = join(PICTURES, `${name}.png`);
  const native = join(PICTURES, `${name}-native.png`);
  writeFileSync(png, await canvasPng(page));
  const { eye, target, fov_deg: fov } = await view(page);
  const { shift, size } = await page.evaluate(() => {
    const { viewer, page } = window.yamanami;
    const { canvas } = page.session;
    const found = JSON.parse(viewer.pick(canvas.width / 2, canvas.height / 2));
    return { shift: [found.source[0] - found.local[0], found.source[1] - found.local[1], found.height_m - found.local[2]], size: [canvas.width, canvas.height] };
  });
  const place = (p) => p.map((value, axis) => value + shift[axis]).join(',');
  run('render', database, '-o', native, '--eye', place(eye), '--target', place(target), '--fov', String(fov), '--size', size.join('x'), '--tolerance-px', '0.5', '--draw', 'gpu');
  const alike = compare(png, native);
  console.log(`${name}: SSIM ${alike.ssim.toFixed(4)}, mean difference ${JSON.stringify(alike)}`);
  return alike;
}

/** The same of a deformed map: its ground alone, which stands on another background. */
async function mapAgainstNative(page, database) {
  await change(page, { tolerance_px: 0.5, budget: null });
  const [png, native] = ['map.png', 'map-native.png'].map((name) => join(PICTURES, name));
  writeFileSync(png, await canvasPng(page));
  const { map, at, size } = await page.evaluate(() => {
    const { settings, facts, canvas } = window.yamanami.page.session;
    return { map: settings.map, at: facts.centre_lon_lat, size: [canvas.width, canvas.height] };
  });
  // as the viewer reads it: a fifth more than it shows, 448 samples to that
  const spacing = (1200 * map.radius_km) / 448;
  run('map', database, '-o', native, '--at', `${at[1]},${at[0]}`, '--radius', String(map.radius_km), '--ring', String(map.ring_km), '--eye', String(map.eye_m), '--curvature', 'none', '--bare', '--stretch', '--tolerance-px', '0.5', '--spacing', String(spacing), '--size', size.join('x'));
  const alike = compare(png, native);
  console.log(`map: SSIM ${alike.ssim.toFixed(4)}`);
  return alike;
}

describe('a terrain', () => {
  it('is shown as natively, coarse first and whole at rest', () =>
    withPage({}, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      assert.ok((await colours(page)) > 200);
      const { ssim } = await againstNative(page, 'hills', data.file('hills.yama'));
      assert.ok(ssim > LEAST_SSIM, `SSIM ${ssim}`);
    }));

  it('follows drags, the wheel and keys, and comes home', () =>
    withPage({ viewport: { width: 700, height: 480 } }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await page.click('#fold');
      const moves = [
        ['a drag', async () => drag(page, 'left')],
        ['a drag with the right button', async () => drag(page, 'right')],
        ['the wheel', async () => { await page.mouse.move(240, 160); await page.mouse.wheel(0, -300); }],
        ['a key', async () => { await page.focus('#stage'); await page.keyboard.press('w'); }],
        ['a button', async () => page.click('#tool-nearer')],
        ['a double click', async () => page.mouse.dblclick(250, 180)],
      ];
      const first = await view(page);
      for (const [name, move] of moves) {
        const from = await view(page);
        await move();
        await moved(page, from, name);
        await atRest(page);
      }
      await page.keyboard.press('h');
      await page.waitForFunction(([x, y]) => Math.hypot(JSON.parse(window.yamanami.viewer.view()).eye[0] - x, JSON.parse(window.yamanami.viewer.view()).eye[1] - y) < 1, first.eye);
      await page.keyboard.press('f');
      assert.equal(await page.getAttribute('#tool-fly', 'aria-pressed'), 'true');
    }));

  it('has controls that do what they say', () =>
    withPage({ viewport: { width: 800, height: 700 } }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await change(page, { budget: null, tolerance_px: 0.5, tolerance_m: 0 });
      const fine = (await stats(page)).triangles;
      await page.getByRole('spinbutton', { name: 'Tolerance on screen' }).fill('8');
      await page.keyboard.press('Tab');
      await page.waitForFunction((n) => window.yamanami.stats().triangles < n, fine);
      await page.getByLabel('Most triangles').first().check();
      await page.getByRole('spinbutton', { name: 'Most triangles' }).fill('800');
      await page.keyboard.press('Tab');
      await page.getByRole('spinbutton', { name: 'Tolerance on screen' }).fill('0.1');
      await page.keyboard.press('Tab');
      await page.waitForFunction(() => window.yamanami.stats().triangles <= 800 && window.yamanami.stats().triangles > 500);
      await page.getByRole('slider', { name: 'Sun height' }).focus();
      await page.keyboard.press('ArrowRight');
      assert.notEqual((await settings(page)).sun_altitude_deg, 45);
      await page.getByLabel('staircase').check({ force: true });
      assert.equal((await settings(page)).control, 'paper');
      await page.getByRole('radio', { name: 'slope' }).check({ force: true });
      assert.equal((await settings(page)).colour, 'slope');
      await page.getByRole('checkbox', { name: 'Edges', exact: true }).check();
      assert.equal((await settings(page)).wireframe, true);
      await atRest(page);
      await page.screenshot({ path: join(PICTURES, 'controls.png') });
    }));

  it('tells heights and profiles as its source has them', () =>
    withPage({ viewport: { width: 900, height: 600 } }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await page.evaluate(() => window.yamanami.viewer.zoom(0.05, 450, 300));
      await page.evaluate(() => window.yamanami.page.wake());
      await page.waitForFunction(() => window.yamanami.isAtRest && JSON.parse(window.yamanami.viewer.pick(450, 300)).exact);
      const found = await page.evaluate(() => JSON.parse(window.yamanami.viewer.pick(450, 300)));
      const [exact] = JSON.parse(run('heights', data.file('hills.tif'), '--crs', '32654', '--at', found.source.join(','), '--json'));
      assert.ok(Math.abs(found.height_m - exact.height_m) < 0.6, `${found.height_m} ${exact.height_m}`);
      await page.mouse.move(450, 300);
      await page.waitForFunction(() => /height/.test(document.getElementById('readout').textContent));
      await page.evaluate(() => { window.yamanami.viewer.home(); window.yamanami.page.wake(); });
      await atRest(page);
      await page.focus('#stage');
      await page.keyboard.press('p');
      await page.mouse.click(500, 260);
      await page.mouse.click(700, 300);
      await page.waitForFunction(() => window.yamanami.page.profile.data?.exact);
      const { profile, ends } = await page.evaluate(() => {
        const { profile, viewer } = window.yamanami.page;
        const marks = profile.marks();
        const found = JSON.parse(viewer.pick(450, 300));
        const shift = [found.source[0] - found.local[0], found.source[1] - found.local[1]];
        return { profile: profile.data, ends: [0, 3].map((at) => [marks.places[at] + shift[0], marks.places[at + 1] + shift[1]]) };
      });
      const line = ends.map((end) => end.join(',')).join(' ');
      const section = JSON.parse(run('profile', data.file('hills.tif'), '--crs', '32654', '--line', line, '--json'));
      const [low, high] = [Math.min(...profile.height_m), Math.max(...profile.height_m)];
      assert.ok(Math.abs(section.length_m - profile.distance_m.at(-1)) < 0.5, `${section.length_m} ${profile.distance_m.at(-1)}`);
      assert.ok(Math.abs(section.lowest_m - low) < 2 && Math.abs(section.highest_m - high) < 2, `${section.lowest_m} ${low} ${section.highest_m} ${high}`);
      assert.match(await page.textContent('#profile-facts'), /data every 30 m/);
      assert.equal(await page.locator('#plot svg .line').count(), 1);
      await page.screenshot({ path: join(PICTURES, 'profile.png') });
      const [csv] = await Promise.all([page.waitForEvent('download'), page.click('#profile .buttons button:nth-child(2)')]);
      assert.match(await readFile(await csv.path(), 'utf8'), /^distance_m,height_m,lon,lat\r\n0\.000,/);
    }));

  it('carries lines and places from files', () =>
    withPage({ viewport: { width: 900, height: 600 } }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      const [lon, lat] = await page.evaluate(() => window.yamanami.page.session.facts.centre_lon_lat);
      const at = (east, north) => `lat="${lat + north}" lon="${lon + east}"`;
      const gpx = `<?xml version="1.0"?><gpx xmlns="http://www.topografix.com/GPX/1/1"><wpt ${at(0.01, 0)}><name>峠 Pass</name></wpt><trk><trkseg><trkpt ${at(-0.02, -0.01)}/><trkpt ${at(0.02, 0.015)}/></trkseg></trk></gpx>`;
      await drop(page, 'walk.gpx', gpx);
      await page.waitForFunction(() => window.yamanami.page.layers.files.length === 1);
      assert.match(await page.textContent('#messages'), /walk\.gpx: 1 lines and 1 places/);
      await drop(page, 'far.geojson', JSON.stringify({ type: 'Point', coordinates: [0, 0] }));
      await drop(page, 'bad.gpx', '<gpx><trk>');
      await drop(page, 'bad.json', '{"type":"Point","coordinates":[400000,5000000]}');
      await page.waitForFunction(() => /longitude/.test(document.getElementById('messages').textContent));
      assert.match(await page.textContent('#messages'), /far\.geojson lies outside/);
      assert.match(await page.textContent('#messages'), /bad\.gpx cannot be read/);
      assert.equal(await page.evaluate(() => window.yamanami.page.layers.files.length), 1);
      // Chromium's own page about XML that is not well-formed carries styles, which the policy forbids
      page.faults = page.faults.filter((fault) => !/^Applying inline style/.test(fault));
      await page.screenshot({ path: join(PICTURES, 'overlay.png') });
    }));

  it('speaks Japanese, and links bring back the same picture', () =>
    withPage({}, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await page.click('#language');
      assert.equal(await page.evaluate(() => document.documentElement.lang), 'ja');
      assert.match(await page.textContent('#controls'), /許容誤差/);
      await page.evaluate(() => { window.yamanami.viewer.turn(120, 20); window.yamanami.viewer.zoom(0.6, 200, 200); });
      await change(page, { colour: 'slope', budget: 5000, sun_azimuth_deg: 120 });
      await page.waitForFunction(() => /c=slope/.test(location.hash) && /v=\(/.test(location.hash) && /l=ja/.test(location.hash));
      await page.waitForTimeout(600);
      const first = join(PICTURES, 'link-1.png');
      writeFileSync(first, await canvasPng(page));
      const address = page.url();
      await page.goto('about:blank');
      await open(page, address);
      assert.equal(await page.evaluate(() => document.documentElement.lang), 'ja');
      const second = join(PICTURES, 'link-2.png');
      writeFileSync(second, await canvasPng(page));
      const { ssim } = compare(first, second);
      assert.ok(ssim > 0.995, `SSIM ${ssim}`);
    }));

  it('saves a picture with its title', () =>
    withPage({}, async (page) => {
      await open(page, `${site.url}/#s=hills`);
      const [picture] = await Promise.all([page.waitForEvent('download'), page.click('#tool-picture')]);
      await picture.saveAs(join(PICTURES, 'saved.png'));
      assert.equal(picture.suggestedFilename(), 'hills.png');
    }));
});

describe('a scan', () => {
  it('is shown as natively', () =>
    withPage({}, async (page) => {
      await open(page, `${server.url}/view/#s=pagoda`);
      assert.ok((await colours(page)) > 100);
      const { ssim } = await againstNative(page, 'pagoda', data.file('pagoda.yama'));
      assert.ok(ssim > LEAST_SSIM, `SSIM ${ssim}`);
    }));
});

describe('a deformed map', () => {
  it('is shown, and its numbers change it', () =>
    withPage({ viewport: { width: 700, height: 480 } }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await page.click('#tool-map');
      await page.waitForFunction(() => window.yamanami.page.session.settings.mode === 'map');
      await atRest(page);
      assert.ok((await colours(page)) > 100);
      const { ssim } = await mapAgainstNative(page, data.file('hills.yama'));
      assert.ok(ssim > LEAST_MAP_SSIM, `SSIM ${ssim}`);
      const shots = [];
      for (const alpha of [0, 0.6]) {
        await change(page, { map: { alpha } });
        shots.push(join(PICTURES, `map-${alpha}.png`));
        writeFileSync(shots.at(-1), await canvasPng(page));
      }
      assert.ok(compare(...shots).ssim < 0.98, 'alpha changes the picture');
      assert.equal(await page.locator('#controls .map').isVisible(), true);
      await page.getByRole('button', { name: 'near', exact: true }).click();
      await atRest(page);
      await page.screenshot({ path: join(PICTURES, 'map-page.png') });
    }));
});

describe('a static site', () => {
  it('is the same page over any web server', () =>
    withPage({ viewport: { width: 700, height: 480 } }, async (page) => {
      await open(page, `${site.url}/#s=pagoda`);
      assert.ok((await colours(page)) > 100);
      await page.getByRole('button', { name: 'hills' }).click();
      await page.waitForFunction(() => window.yamanami.page.session.surface.name === 'hills');
      await atRest(page);
      assert.ok((await colours(page)) > 200);
      await page.click('#tool-map');
      await page.waitForFunction(() => window.yamanami.page.session.settings.mode === 'map');
      await atRest(page);
      assert.ok((await colours(page)) > 100);
    }));
});

describe('a phone', () => {
  it('has the controls in a sheet, and fingers move the land', () =>
    withPage({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1, locale: 'ja-JP' }, async (page) => {
      await open(page, `${server.url}/view/#s=hills`);
      await page.screenshot({ path: join(PICTURES, 'phone.png') });
      const from = await view(page);
      await pinch(page, [195, 400], 60, 160);
      await moved(page, from, 'a pinch');
      await page.touchscreen.tap(195, 450);
      await page.waitForFunction(() => /標高/.test(document.getElementById('readout').textContent));
      await page.click('#fold');
      await page.screenshot({ path: join(PICTURES, 'phone-sheet.png') });
      const box = await page.locator('#panel').boundingBox();
      assert.ok(box.width === 390 && box.y > 200 && box.y + box.height <= 845, JSON.stringify(box));
    }));
});

describe('WebGPU', () => {
  it('draws the same where it starts', async (context) => {
    const other = await launch('webgpu');
    try {
      const page = await newPage(other);
      await page.goto(`${server.url}/view/#s=hills&gpu=webgpu`);
      await page.evaluate(() => window.yamanami.ready);
      if ((await page.locator('.blocked').count()) > 0) return context.skip(await page.textContent('.blocked .detail'));
      await atRest(page);
      const { ssim } = await againstNative(page, 'hills-webgpu', data.file('hills.yama'));
      assert.ok(ssim > LEAST_SSIM, `SSIM ${ssim}`);
      assert.ok(existsSync(join(PICTURES, 'hills-webgpu.png')));
    } finally {
      await other.close();
    }
  });
});

async function drag(page, button) {
  await page.mouse.move(200, 160);
  await page.mouse.down({ button });
  await page.mouse.move(230, 170, { steps: 3 });
  await page.mouse.up({ button });
}

async function drop(page, name, text) {
  const transfer = await page.evaluateHandle(([fileName, content]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([content], fileName));
    return transfer;
  }, [name, text]);
  await page.dispatchEvent('body', 'drop', { dataTransfer: transfer });
}

/** Two fingers about a place go from one distance to another. */
async function pinch(page, [x, y], from, to) {
  const client = await page.context().newCDPSession(page);
  const touch = (type, apart) =>
    client.send('Input.dispatchTouchEvent', { type, touchPoints: apart === null ? [] : [{ x: x - apart / 2, y, id: 1 }, { x: x + apart / 2, y, id: 2 }] });
  await touch('touchStart', from);
  for (let step = 1; step <= 4; step += 1) await touch('touchMove', from + ((to - from) * step) / 4);
  await touch('touchEnd', null);
}
