// A static web server for tests: ranges, ETags, and faults on request.

import { createServer } from 'node:http';
import { createHash } from 'node:crypto';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.svg': 'image/svg+xml', '.wasm': 'application/wasm', '.png': 'image/png' };

/**
 * Serves files by address: `routes` maps a path's beginning to a folder, the longest first. `faults` may be changed while it
 * runs: noRanges (answers 200 to ranges), damage(path, bytes, offset) (returns what is sent), status(path) (a status to refuse
 * with), delayMs.
 */
export async function serveStatic(routes, port = 0) {
  const faults = {};
  const served = { bytes: 0, requests: 0 };
  const files = new Map();
  const open = async (path) => {
    const route = Object.keys(routes).filter((start) => path.startsWith(start)).sort((a, b) => b.length - a.length)[0];
    if (route === undefined) throw new Error('no route');
    const rest = path.slice(route.length);
    const file = rest === '' && !path.endsWith('/') ? routes[route] : join(routes[route], normalize(`/${rest}`));
    const bytes = await readFile(path.endsWith('/') ? join(file, 'index.html') : file);
    return { bytes, etag: `"${createHash('sha256').update(bytes).digest('hex').slice(0, 16)}"` };
  };
  const server = createServer(async (request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    served.requests += 1;
    if (faults.delayMs) await new Promise((resolve) => setTimeout(resolve, faults.delayMs));
    const status = faults.status?.(path);
    if (status) return response.writeHead(status).end();
    try {
      if (!files.has(path) || faults.fresh) files.set(path, await open(path));
    } catch {
      return response.writeHead(404).end();
    }
    const { bytes, etag } = files.get(path);
    const headers = { 'Content-Type': TYPES[extname(path) || '.html'] ?? 'application/octet-stream', ETag: etag, 'Cache-Control': 'no-cache' };
    const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? '');
    if (!range || faults.noRanges) {
      served.bytes += bytes.length;
      return response.writeHead(200, { ...headers, 'Content-Length': bytes.length }).end(bytes);
    }
    const first = Number(range[1]);
    if (first >= bytes.length) return response.writeHead(416, { ...headers, 'Content-Range': `bytes */${bytes.length}` }).end();
    const last = Math.min(range[2] ? Number(range[2]) : Infinity, bytes.length - 1);
    const part = bytes.subarray(first, last + 1);
    served.bytes += part.length;
    const lengths = { 'Content-Length': part.length, 'Accept-Ranges': 'bytes', 'Content-Range': `bytes ${first}-${last}/${bytes.length}` };
    response.writeHead(206, { ...headers, ...lengths }).end(faults.damage?.(path, Buffer.from(part), first) ?? part);
  });
  await new Promise((resolve, reject) => server.once('error', reject).listen(port, '127.0.0.1', resolve));
  const close = () => {
    server.closeAllConnections();
    return new Promise((resolve) => server.close(resolve));
  };
  return { url: `http://127.0.0.1:${server.address().port}`, port: server.address().port, faults, served, close };
}
