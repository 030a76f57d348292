// The viewer in a browser where things go wrong: node --test web_tests/faults.mjs

import assert from 'node:assert/strict';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { launch, newPage } from './browser.mjs';
import { serveStatic } from './server.mjs';
import { PICTURES, atRest, colours, makeData, makeSite, open, serveProgram } from './setup.mjs';

let data, browser, folder;

before(async () => {
  data = makeData();
  const server = await serveProgram([data.file('hills.yama'), data.file('pagoda.yama')]);
  folder = data.file('site');
  await makeSite(folder, server, ['hills', 'pagoda']);
  await server.stop();
  browser = await launch('webgl2');
});

after(async () => {
  await browser?.close();
  data?.remove();
});

/** A static site of its own with a page, both closed after the test. Uncaught errors fail it. */
async function withSite(test) {
  const site = await serveStatic({ '/': folder });
  const page = await newPage(browser);
  try {
    await test(page, site);
    assert.deepEqual(page.faults, []);
  } finally {
    await page.context().close();
    await site.close();
  }
}

const says = (page, words) => page.waitForFunction((text) => new RegExp(text).test(document.body.innerText), words.source);
const isPack = (path) => path.endsWith('.pack');

describe('a surface', () => {
  it('that is cut short is told, and the page says why it shows nothing', () =>
    withSite(async (page, site) => {
      const whole = readFileSync(join(folder, 'hills.pack'));
      cpSync(folder, data.file('short'), { recursive: true });
      writeFileSync(join(data.file('short'), 'hills.pack'), whole.subarray(0, 500));
      const short = await serveStatic({ '/': data.file('short') });
      await page.goto(`${short.url}/`);
      await says(page, /cannot be (read|loaded|drawn)/);
      await page.screenshot({ path: join(PICTURES, 'cut-short.png') });
      await short.close();
      assert.ok(site.url);
    }));

  it('that is no packed surface is told', () =>
    withSite(async (page, site) => {
      site.faults.damage = (path, bytes) => (isPack(path) ? Buffer.alloc(bytes.length, 65) : bytes);
      await page.goto(`${site.url}/`);
      await says(page, /YAMAPAK1/);
    }));

  it('with damaged parts is shown coarser there', () =>
    withSite(async (page, site) => {
      const size = readFileSync(join(folder, 'hills.pack')).length;
      // the last tenth: finest details
      site.faults.damage = (path, bytes, first) => {
        if (isPack(path)) for (let i = Math.max(0, Math.floor(0.9 * size) - first); i < bytes.length; i += 97) bytes[i] ^= 0x55;
        return bytes;
      };
      await page.goto(`${site.url}/#t=0.01&tm=0&b=!n`);
      await page.evaluate(() => window.yamanami.ready);
      await says(page, /arrived damaged/);
      await page.waitForFunction(() => window.yamanami.viewer && JSON.parse(window.yamanami.viewer.view()).eye);
      await page.waitForTimeout(500);
      assert.ok((await colours(page)) > 100);
      await page.screenshot({ path: join(PICTURES, 'damaged.png') });
    }));

  it('of a server without ranges is taken whole', () =>
    withSite(async (page, site) => {
      site.faults.noRanges = true;
      await open(page, `${site.url}/`);
      assert.ok((await colours(page)) > 200);
    }));

  it('that is not there is told', () =>
    withSite(async (page, site) => {
      site.faults.status = (path) => (isPack(path) ? 404 : 0);
      await page.goto(`${site.url}/`);
      await says(page, /404/);
    }));
});

describe('a server', () => {
  it('that goes away and comes back is waited for', async () => {
    const page = await newPage(browser);
    let server = await serveProgram([data.file('hills.yama')]);
    await open(page, `${server.url}/view/#s=hills`);
    await server.stop('SIGKILL');
    await page.evaluate(() => {
      const { viewer, page } = window.yamanami;
      page.change({ tolerance_px: 0.05, tolerance_m: 0, budget: null });
      viewer.zoom(0.2, 240, 160);
      page.wake();
    });
    await says(page, /Connection lost/);
    await page.screenshot({ path: join(PICTURES, 'lost.png') });
    server = await serveProgram([data.file('hills.yama')], server.port);
    await says(page, /connection is back/);
    await atRest(page);
    await server.stop();
    await page.context().close();
  });

  it('that has another file now asks for a reload', () =>
    withSite(async (page, site) => {
      site.faults.fresh = true;
      cpSync(folder, data.file('changing'), { recursive: true });
      const changing = await serveStatic({ '/': data.file('changing') });
      changing.faults.fresh = true;
      await open(page, `${changing.url}/`);
      writeFileSync(join(data.file('changing'), 'hills.pack'), readFileSync(join(folder, 'pagoda.pack')));
      await page.evaluate(() => {
        window.yamanami.page.change({ tolerance_px: 0.05, tolerance_m: 0, budget: null });
        window.yamanami.viewer.zoom(0.2, 240, 160);
        window.yamanami.page.wake();
      });
      await says(page, /has been changed on the server/);
      assert.equal(await page.locator('#alarm button').textContent(), 'Reload the page');
      await page.screenshot({ path: join(PICTURES, 'changed.png') });
      await changing.close();
    }));

  it('that falters is tried again', () =>
    withSite(async (page, site) => {
      let refused = 0;
      site.faults.status = (path) => (isPack(path) && (refused += 1) < 4 ? 503 : 0);
      await open(page, `${site.url}/`);
      assert.ok(refused >= 4);
    }));
});

describe('links with nonsense', () => {
  for (const hash of ['#a=banana&m=7&t=-1&v=(eye:!(1,2)&zz=1&%E0%A4%A', `#${'x'.repeat(9000)}`, '#s=%00&c=pink&b=1e99', '#v=(eye:!(1,2,3),target:!(1,2,3))', '#s=../../etc&m=map&z=1&a=1&c=pink']) {
    it(`show the surface all the same: ${hash.slice(0, 40)}`, () =>
      withSite(async (page, site) => {
        await open(page, `${site.url}/${hash}`);
        await says(page, /not understood|no surface/);
        assert.ok((await colours(page)) > 100);
      }));
  }
});

describe('a browser', () => {
  it('without WebGL 2 is told so', async () => {
    const other = await launch('none');
    const site = await serveStatic({ '/': folder });
    const page = await newPage(other);
    await page.goto(`${site.url}/`);
    await says(page, /WebGL 2/);
    await page.screenshot({ path: join(PICTURES, 'no-webgl.png') });
    await other.close();
    await site.close();
  });

  it('that loses its graphics device goes on at the same view', () =>
    withSite(async (page, site) => {
      await open(page, `${site.url}/`);
      await page.evaluate(() => {
        window.yamanami.viewer.turn(200, 0);
        window.yamanami.page.wake();
      });
      await atRest(page);
      const before = await page.evaluate(() => window.yamanami.viewer.view());
      await page.evaluate(() => {
        const { canvas } = window.yamanami.page.session;
        canvas.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
        window.yamanami.page.change({ colour: 'slope' });
      });
      await says(page, /graphics device was lost|viewer stopped/);
      await page.screenshot({ path: join(PICTURES, 'device-lost.png') });
      page.faults.length = 0;
      await page.click('#alarm button');
      await page.waitForFunction(() => window.yamanami.isAtRest);
      assert.equal(await page.evaluate(() => window.yamanami.viewer.view()), before);
      assert.ok((await colours(page)) > 100);
    }));

  it('without a list of surfaces is told', () =>
    withSite(async (page, site) => {
      site.faults.status = (path) => (path.endsWith('site.json') ? 404 : 0);
      await page.goto(`${site.url}/`);
      await says(page, /site\.json/);
    }));
});
