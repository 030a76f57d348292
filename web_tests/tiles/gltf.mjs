// Runs Khronos' gltf-validator over all .glb files of a folder: node gltf.mjs FOLDER... ; exit code 1 where there are errors.

import { readdir, readFile, stat } from 'node:fs/promises';
import { join } from 'node:path';
import validator from 'gltf-validator';

async function glbFiles(path) {
  if ((await stat(path)).isFile()) return [path];
  const names = (await readdir(path, { recursive: true })).filter((name) => name.endsWith('.glb'));
  return names.sort().map((name) => join(path, name));
}

const files = (await Promise.all(process.argv.slice(2).map(glbFiles))).flat();
if (files.length === 0) {
  console.error('usage: node gltf.mjs FOLDER... (folders with .glb files)');
  process.exit(2);
}
const totals = { errors: 0, warnings: 0, infos: 0, hints: 0 };
const seen = new Map();
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), { uri: file, maxIssues: 100 });
  totals.errors += report.issues.numErrors;
  totals.warnings += report.issues.numWarnings;
  totals.infos += report.issues.numInfos;
  totals.hints += report.issues.numHints;
  for (const { code, severity, message, pointer } of report.issues.messages) {
    const known = seen.get(code) ?? { severity, count: 0, first: `${file}: ${pointer ?? ''}: ${message}` };
    known.count += 1;
    seen.set(code, known);
  }
}
const words = ['error', 'warning', 'info', 'hint'];
for (const [code, { severity, count, first }] of seen) console.log(`${words[severity]} ${code} (${count}): ${first}`);
console.log(`${files.length} files: ${totals.errors} errors, ${totals.warnings} warnings, ${totals.infos} infos, ${totals.hints} hints`);
process.exit(totals.errors > 0 ? 1 : 0);
