// Finds lines of more than 120 characters, which no formatter breaks: long texts, comments and markup.
import { readdirSync, readFileSync } from 'node:fs';
import { join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';

const MAX_LENGTH = 120;
const web = fileURLToPath(new URL('..', import.meta.url));
const kinds = /\.(ts|mjs|js|svelte|css|html)$/;

let count = 0;
for (const folder of ['src', 'scripts']) {
  for (const name of readdirSync(join(web, folder), { recursive: true, encoding: 'utf8' })) {
    if (name.startsWith('generated') || !kinds.test(name)) continue;
    const path = join(web, folder, name);
    for (const [index, line] of readFileSync(path, 'utf8').split('\n').entries()) {
      if (line.length <= MAX_LENGTH) continue;
      console.error(`${relative(web, path)}:${index + 1}: ${line.length} characters, at most ${MAX_LENGTH}`);
      count += 1;
    }
  }
}
process.exitCode = count > 0 ? 1 : 0;
