// Debian's headless Chromium for tests: with WebGL 2 or WebGPU in software.

import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const QUIET = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
const GRAPHICS = {
  webgl2: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  webgpu: ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=swiftshader'],
  none: ['--disable-gpu', '--disable-3d-apis', '--disable-features=WebGPU'],
};

/** Where Chromium is; null when it is not installed. */
export function browserPath() {
  return [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find((path) => path && existsSync(path)) ?? null;
}

export function launch(graphics = 'webgl2') {
  return chromium.launch({ executablePath: browserPath(), headless: true, args: [...QUIET, ...GRAPHICS[graphics]] });
}

/** A page that keeps what its console said: errors of the page end a test. */
export async function newPage(browser, options = {}) {
  const context = await browser.newContext({ viewport: { width: 480, height: 320 }, locale: 'en-GB', ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error' && !/Failed to load resource/.test(message.text())) page.faults.push(message.text());
  });
  return page;
}
