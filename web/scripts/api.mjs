// Writes the types of the station's HTTP API into src/generated/api.ts, from its OpenAPI description. They are needed
// to check types only: a build, whose Python may lack the station's libraries, leaves types out.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import openapiTS, { astToString } from 'openapi-typescript';
import { generated, run } from './python.mjs';

const DESCRIBE = `import json
from mavstack.server.app import describe_station
print(json.dumps(describe_station()))`;

// Members that have a default may be left out.
const types = await openapiTS(run('-c', DESCRIBE), { defaultNonNullable: false });
writeFileSync(join(generated, 'api.ts'), astToString(types));
