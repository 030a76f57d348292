// Loads tiles into CesiumJS in headless Chromium, offline, and compares heights with the program's.
//
//   node cesium.mjs --dem DEM --bounds W,S,E,N --tolerance M [--terrain DIR] [--tiles DIR] [--places N] [--offset M]
//                   [--samples X,Y,STEP] [--program YAMANAMI] [--picture OUT.png]
//
// DEM has longitudes and latitudes. --terrain is a quantized-mesh pyramid: heights of the finest tiles are asked for by
// sampleTerrainMostDetailed, and those of the globe as it is drawn by globe.getHeight where it is near. --tiles is a 3D Tiles
// folder: it is loaded, drawn, and heights are asked for by scene.sampleHeightMostDetailed at some of the places. --offset is what
// the tiles' heights lie above the DEM's. With --samples, a sample and the step between them in degrees, places are samples. Exit code 1 where a height is further off than the tolerance.

import { execFileSync } from 'node:child_process';
import { createReadStream, existsSync, mkdtempSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { chromium } from 'playwright-core';

const HERE = dirname(fileURLToPath(import.meta.url));
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.wasm': 'application/wasm', '.png': 'image/png', '.jpg': 'image/jpeg', '.glb': 'model/gltf-binary' };
const FLAGS = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

const text = (usual) => ({ type: 'string', default: usual });
const { values: args } = parseArgs({
  options: { dem: text(), bounds: text(), tolerance: text('1'), terrain: text(), tiles: text(), places: text('1000'), offset: text('0'), samples: text(), program: text('yamanami'), picture: text('cesium.png') },
});
if (!args.dem || !args.bounds || !(args.terrain || args.tiles)) {
  console.error('usage: node cesium.mjs --dem DEM --bounds W,S,E,N --tolerance M [--terrain DIR] [--tiles DIR]');
  process.exit(2);
}

/** Places spread evenly, the same at every run, and the DEM's heights there. */
function heightsOfProgram([west, south, east, north], count) {
  const places = Array.from({ length: count }, (_, k) => {
    // the additive sequence of the plastic number fills a square evenly
    const [s, t] = [0.7548776662466927, 0.5698402909980532].map((step) => (0.5 + step * (k + 1)) % 1);
    const place = [west + s * (east - west), south + t * (north - south)];
    if (!args.samples) return place;
    // between samples a mesh and a grid differ by themselves
    const [x, y, step] = args.samples.split(',').map(Number);
    return place.map((v, axis) => [x, y][axis] + Math.round((v - [x, y][axis]) / step) * step);
  });
  const folder = mkdtempSync(join(tmpdir(), 'yamanami-places-'));
  try {
    const file = join(folder, 'places.csv');
    writeFileSync(file, `x,y\n${places.map((p) => p.join(',')).join('\n')}\n`);
    const printed = execFileSync(args.program, ['heights', args.dem, '--points', file, '--json'], { encoding: 'utf8', maxBuffer: 1 << 26 });
    return JSON.parse(printed).filter((p) => p.height_m !== null).map((p) => ({ lon: p.x, lat: p.y, height_m: p.height_m + Number(args.offset) }));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

function serve() {
  const routes = { '/cesium/': join(HERE, 'node_modules/cesium/Build/Cesium'), '/terrain/': args.terrain, '/tiles/': args.tiles };
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    if (path === '/') return response.writeHead(200, { 'Content-Type': 'text/html' }).end(PAGE);
    const route = Object.keys(routes).find((start) => path.startsWith(start) && routes[start]);
    const file = route && join(routes[route], normalize(`/${path.slice(route.length)}`));
    if (!file || !existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end();
    const headers = { 'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream' };
    const stream = createReadStream(file);
    stream.once('data', (start) => {
      if (start[0] === 0x1f && start[1] === 0x8b) headers['Content-Encoding'] = 'gzip';
      response.writeHead(200, headers).write(start);
      stream.pipe(response);
    });
  });
  return new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(server)));
}

const PAGE = `<!doctype html><link rel="stylesheet" href="/cesium/Widgets/widgets.css">
<style>html,body,#globe{margin:0;width:480px;height:320px}</style><div id="globe"></div>
<script>window.CESIUM_BASE_URL = '/cesium/'</script><script src="/cesium/Cesium.js"></script>`;

/** Runs in the page. */
async function measure({ places, bounds, hasTerrain, hasTiles }) {
  const Cesium = window.Cesium;
  Cesium.Ion.defaultAccessToken = '';
  const viewer = new Cesium.CesiumWidget('globe', {
    baseLayer: Cesium.ImageryLayer.fromProviderAsync(Cesium.TileMapServiceImageryProvider.fromUrl('/cesium/Assets/Textures/NaturalEarthII')),
    terrainProvider: hasTerrain ? await Cesium.CesiumTerrainProvider.fromUrl('/terrain/') : undefined,
    skyBox: false, skyAtmosphere: false, msaaSamples: 1, contextOptions: { webgl: { preserveDrawingBuffer: true } },
  });
  const { scene } = viewer;
  window.viewer = viewer;
  scene.fog.enabled = false;
  scene.globe.showGroundAtmosphere = false;
  const result = { faults: [] };
  scene.renderError.addEventListener((_, error) => result.faults.push(String(error)));
  const settled = async (isDone, seconds) => {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end; ) {
      scene.requestRender();
      await new Promise((resolve) => setTimeout(resolve, 200));
      if (isDone()) return true;
    }
    return false;
  };
  const cartographic = (p) => Cesium.Cartographic.fromDegrees(p.lon, p.lat);
  const [west, south, east, north] = bounds;
  if (hasTerrain) {
    const sampled = await Cesium.sampleTerrainMostDetailed(viewer.scene.globe.terrainProvider, places.map(cartographic));
    result.terrain = sampled.map((c) => c.height ?? null);
    viewer.camera.setView({ destination: Cesium.Rectangle.fromDegrees(west, south, east, north) });
    scene.globe.maximumScreenSpaceError = 1;
    result.globeLoaded = await settled(() => scene.globe.tilesLoaded, 120);
    result.globe = places.map((p) => scene.globe.getHeight(cartographic(p)) ?? null);
  }
  if (hasTiles) {
    scene.globe.show = false;
    const tileset = await Cesium.Cesium3DTileset.fromUrl('/tiles/tileset.json', { maximumScreenSpaceError: 1 });
    tileset.tileFailed.addEventListener((e) => result.faults.push(e.message));
    scene.primitives.add(tileset);
    await viewer.camera.flyToBoundingSphere(tileset.boundingSphere, { duration: 0, offset: new Cesium.HeadingPitchRange(0, -0.9, 2 * tileset.boundingSphere.radius) });
    result.tilesLoaded = await settled(() => tileset.tilesLoaded, 180);
    const some = places.filter((_, k) => k % Math.ceil(places.length / 50) === 0);
    const sampled = await scene.sampleHeightMostDetailed(some.map(cartographic), [], 0.1);
    result.tiles = sampled.map((c, k) => ({ expected: some[k].height_m, found: c.height ?? null }));
    const count = tileset.statistics ?? tileset._statistics;
    result.tilesDrawn = count?.selected ?? null;
  }
  await new Promise((resolve) => setTimeout(resolve, 500));
  return result;
}

/** Greatest and root mean square difference, and how many are missing. */
function compared(name, pairs, tolerance) {
  const apart = pairs.filter(([, found]) => found !== null).map(([expected, found]) => Math.abs(found - expected));
  const max = Math.max(...apart, 0);
  const rms = Math.sqrt(apart.reduce((sum, d) => sum + d * d, 0) / Math.max(apart.length, 1));
  const missing = pairs.length - apart.length;
  const passed = apart.length > 0 && missing === 0 && max <= tolerance;
  console.log(`${passed ? 'pass' : 'FAIL'}  ${name}: ${apart.length} places, at most ${max.toFixed(3)} m apart, rms ${rms.toFixed(3)} m, ${missing} missing; allowed ${tolerance} m`);
  return passed;
}

const bounds = args.bounds.split(',').map(Number);
const places = heightsOfProgram(bounds, Number(args.places));
const server = await serve();
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', headless: true, args: FLAGS });
let passed = places.length > 0;
try {
  const page = await browser.newPage({ viewport: { width: 480, height: 320 } });
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.setDefaultTimeout(300_000);
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const found = await page.evaluate(measure, { places, bounds, hasTerrain: !!args.terrain, hasTiles: !!args.tiles });
  const tolerance = Number(args.tolerance);
  if (found.terrain) {
    passed &&= compared('finest terrain', places.map((p, k) => [p.height_m, found.terrain[k]]), tolerance);
    // as drawn: coarser where it is far; the error of the screen is then a pixel of some metres
    const drawn = found.globe.filter((h) => h !== null).length;
    const worst = Math.max(...found.globe.map((h, k) => (h === null ? 0 : Math.abs(h - places[k].height_m))));
    console.log(`      globe as drawn: ${drawn} places, at most ${worst.toFixed(3)} m apart; all loaded: ${found.globeLoaded}`);
    passed &&= drawn > 0;
  }
  if (found.tiles) {
    passed &&= compared('3D Tiles', found.tiles.map((t) => [t.expected, t.found]), tolerance);
    console.log(`      ${found.tilesDrawn} tiles drawn; all loaded: ${found.tilesLoaded}`);
  }
  for (const fault of [...faults, ...found.faults]) console.log(`FAIL  ${fault}`);
  passed &&= faults.length + found.faults.length === 0;
  await page.screenshot({ path: args.picture, timeout: 60_000 });
  console.log(`      picture: ${args.picture}`);
} finally {
  await browser.close();
  server.close();
}
process.exit(passed ? 0 : 1);
