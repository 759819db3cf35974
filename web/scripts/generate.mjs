// Generates what the station knows of MAVLink into src/generated: message classes by `mav gen typescript all`, the
// commands of missions with their params by `mav dialect show all MAV_CMD`, those with a place, the parameters that
// belong to one vehicle only, of which `mav param load` and the page leave the same ones out, and the uses of modes,
// such as those in which a firmware does not arm. The messages of MSP are the tables of `mavstack.msp`.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { generated, run } from './python.mjs';

const OWNED = `import json
from mavstack.files.parameters import owned_patterns
print(json.dumps({owner.name: patterns for owner, patterns in owned_patterns().items()}))`;

const MODES = `import json
from mavstack.vehicle.firmware.mode_facts import mode_facts
print(json.dumps(mode_facts()))`;

const MSP = `import json
from mavstack.msp.messages.layout_tables import msp_facts
print(json.dumps(msp_facts()))`;

const mav = (...words) => run('-m', 'mavstack', ...words);

process.stdout.write(mav('gen', 'typescript', 'all', '-o', generated));
const commands = mav('dialect', 'show', 'all', 'MAV_CMD', '--json');
const located = JSON.parse(commands).entries.filter((entry) => entry.has_location);
writeFileSync(join(generated, 'commands.json'), commands);
writeFileSync(join(generated, 'located.json'), JSON.stringify(located.map((entry) => entry.value)));
writeFileSync(join(generated, 'owned.json'), run('-c', OWNED));
writeFileSync(join(generated, 'modes.json'), run('-c', MODES));
writeFileSync(join(generated, 'msp.json'), run('-c', MSP));
