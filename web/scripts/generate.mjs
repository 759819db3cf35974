// Generates what the station knows of MAVLink into src/generated: message classes by `mav gen typescript all`,
// and the commands of missions with their params by `mav dialect show all MAV_CMD`.
//
// Python is the one of the variable MAVSTACK_PYTHON, the project's virtual environment, or `python3`; PYTHONPATH tells
// where the package is, if not in the folder `src`.
import { spawnSync } from 'node:child_process';
import { existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const top = fileURLToPath(new URL('../..', import.meta.url));
const environment = join(top, '.venv', 'bin', 'python');
const python = process.env.MAVSTACK_PYTHON ?? (existsSync(environment) ? environment : 'python3');
const source = process.env.PYTHONPATH ?? join(top, 'src');
const generated = join(top, 'web', 'src', 'generated');

/** Runs `mav` and returns what it wrote; its errors go to the terminal. */
function mav(...words) {
  const env = { ...process.env, PYTHONPATH: source };
  const result = spawnSync(python, ['-m', 'mavstack', ...words], { stdio: ['ignore', 'pipe', 'inherit'], env });
  if (result.error) console.error(`mav ${words[0]} failed: ${python}: ${result.error.message}`);
  if (result.status !== 0) process.exit(result.status ?? 1);
  return result.stdout;
}

process.stdout.write(mav('gen', 'typescript', 'all', '-o', generated));
writeFileSync(join(generated, 'commands.json'), mav('dialect', 'show', 'all', 'MAV_CMD', '--json'));
