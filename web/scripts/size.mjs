// Size of the first load: the page, and the scripts and styles that it and its first view need, as the station sends
// them.
//
//     node scripts/size.mjs [--limit 1.5]      # exit code 1 above the limit, in MB
import { readFileSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = fileURLToPath(new URL('../../src/mavstack/server/static', import.meta.url));
const FIRST_VIEW = 'src/views/fly/index.svelte';

const manifest = JSON.parse(readFileSync(join(folder, '.vite', 'manifest.json'), 'utf8'));
const files = new Set(['index.html']);
const visited = new Set();

/** Adds a chunk with those that it imports; `later`: also those that it loads by itself, such as the map. */
function add(key, later) {
  if (visited.has(key)) return;
  visited.add(key);
  const chunk = manifest[key];
  files.add(chunk.file);
  for (const name of [...(chunk.css ?? []), ...(chunk.assets ?? [])]) files.add(name);
  for (const name of chunk.imports ?? []) add(name, later);
  if (later) for (const name of chunk.dynamicImports ?? []) add(name, later);
}

add('index.html', false);
add(FIRST_VIEW, true);
for (const name of readdirSync(join(folder, 'assets'))) if (/worker.*js$/i.test(name)) files.add(`assets/${name}`);

/** Returns the size of a file as the station sends it: of scripts and styles the build makes compressed ones. */
function sizeOf(name) {
  const file = join(folder, name);
  return /\.(?:m?js|css)$/.test(name) ? statSync(`${file}.gz`).size : statSync(file).size;
}

const sizes = [...files].map((name) => ({ name, size: sizeOf(name) }));
const total = sizes.reduce((sum, { size }) => sum + size, 0);
for (const { name, size } of sizes.sort((one, other) => other.size - one.size)) {
  console.log(`${(size / 1024).toFixed(1).padStart(8)} kB  ${name}`);
}
console.log(`${(total / 1e6).toFixed(3).padStart(8)} MB  first load, compressed`);
const limit = process.argv.includes('--limit') ? Number(process.argv[process.argv.indexOf('--limit') + 1]) : Infinity;
if (total > limit * 1e6) {
  console.error(`the first load has ${(total / 1e6).toFixed(2)} MB, more than ${limit} MB`);
  process.exit(1);
}
