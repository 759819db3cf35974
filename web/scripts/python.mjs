// Python is the one of the variable MAVSTACK_PYTHON, the project's virtual environment, or `python3`; PYTHONPATH says
// where the package is, if not in the folder `src`.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const top = fileURLToPath(new URL('../..', import.meta.url));
const environment = join(top, '.venv', 'bin', 'python');
const python = process.env.MAVSTACK_PYTHON ?? (existsSync(environment) ? environment : 'python3');
const source = process.env.PYTHONPATH ?? join(top, 'src');

export const generated = join(top, 'web', 'src', 'generated');

/** Runs Python and returns what it wrote; its errors go to the terminal. */
export function run(...words) {
  const env = { ...process.env, PYTHONPATH: source };
  const result = spawnSync(python, words, { stdio: ['ignore', 'pipe', 'inherit'], env, maxBuffer: 2 ** 26 });
  if (result.error) console.error(`${words[1]} failed: ${python}: ${result.error.message}`);
  if (result.status !== 0) process.exit(result.status ?? 1);
  return result.stdout;
}
