/** The rules of imports between folders, which `npm run lint` checks, find what they forbid. */
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { expect, it } from 'vitest';

const WEB = fileURLToPath(new URL('../..', import.meta.url));
const BIOME = join(WEB, 'node_modules', '@biomejs', 'biome', 'bin', 'biome');

/** Modules with one import each, in a project of the same rules. */
const FORBIDDEN = {
  'lib/store/view.ts': '../../views/plan/logic/geo',
  'lib/store/shell.ts': '../../shell/TopBar.svelte',
  'views/plan/other.ts': '../fly/reading',
  'views/plan/logic/shell.ts': '../../../shell/TopBar.svelte',
};
const ALLOWED = {
  'lib/store/sibling.ts': '../map/plan',
  'views/plan/logic/own.ts': '../formats/json',
  'views/setup/library.ts': '$lib/map/plan',
  'shell/view.ts': '../views/logs/format',
};

it('between folders are refused or allowed as the layers say', () => {
  const project = mkdtempSync(join(tmpdir(), 'imports-'));
  copyFileSync(join(WEB, 'biome.jsonc'), join(project, 'biome.jsonc'));
  for (const [module, imported] of Object.entries({ ...FORBIDDEN, ...ALLOWED })) {
    const path = join(project, 'src', module);
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, `import { a } from '${imported}';\na();\n`);
  }
  const words = [BIOME, 'lint', '--only=style/noRestrictedImports'];
  const { stdout, stderr } = spawnSync(process.execPath, words, { cwd: project, encoding: 'utf8' });
  rmSync(project, { recursive: true });
  const found = [...(stdout + stderr).matchAll(/^src\/(\S+?):\d+:\d+ lint\/style\/noRestrictedImports/gm)];
  expect(found.map(([, module]) => module).sort()).toEqual(Object.keys(FORBIDDEN).sort());
});
