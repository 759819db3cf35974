// Generates what the station knows of MAVLink into src/generated: message classes by `mav gen typescript all`, the
// commands of missions with their params by `mav dialect show all MAV_CMD`, those with a place, the parameters that
// belong to one vehicle only, of which `mav param load` and the page leave the same ones out, and the uses of modes,
// such as those in which a firmware does not arm.
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

const OWNED = `import json
from mavstack.files.parameters import owned_patterns
print(json.dumps({owner.name: patterns for owner, patterns in owned_patterns().items()}))`;

const MODES = `import json
from mavstack.vehicle.firmware.mode_facts import mode_facts
print(json.dumps(mode_facts()))`;

/** Runs Python and returns what it wrote; its errors go to the terminal. */
function run(...words) {
  const env = { ...process.env, PYTHONPATH: source };
  const result = spawnSync(python, words, { stdio: ['ignore', 'pipe', 'inherit'], env });
  if (result.error) console.error(`${words[1]} failed: ${python}: ${result.error.message}`);
  if (result.status !== 0) process.exit(result.status ?? 1);
  return result.stdout;
}

const mav = (...words) => run('-m', 'mavstack', ...words);

process.stdout.write(mav('gen', 'typescript', 'all', '-o', generated));
const commands = mav('dialect', 'show', 'all', 'MAV_CMD', '--json');
const located = JSON.parse(commands).entries.filter((entry) => entry.has_location);
writeFileSync(join(generated, 'commands.json'), commands);
writeFileSync(join(generated, 'located.json'), JSON.stringify(located.map((entry) => entry.value)));
writeFileSync(join(generated, 'owned.json'), run('-c', OWNED));
writeFileSync(join(generated, 'modes.json'), run('-c', MODES));
