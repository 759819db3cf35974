// Copies the code of the guide docs/guides/station-panels.md into src/generated/guide, where the types are checked and
// the tests run as those of the station.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const top = fileURLToPath(new URL('../..', import.meta.url));
const guide = join(top, 'docs', 'guides', 'station-panels.md');
const folder = join(top, 'web', 'src', 'generated', 'guide');

if (existsSync(guide)) {
  mkdirSync(folder, { recursive: true });
  const names = ['rangefinder.ts', 'rangefinder.test.ts', 'RangePanel.svelte', 'actions.ts'];
  const blocks = [...readFileSync(guide, 'utf8').matchAll(/```(?:ts|svelte)\n([\s\S]*?)```/g)].map((match) => match[1]);
  if (blocks.length !== names.length)
    throw new Error(`the guide has ${blocks.length} blocks of code, not ${names.length}`);
  blocks.forEach((block, index) => {
    // The text that the fifth step adds.
    writeFileSync(join(folder, names[index]), block.replace("t('fly.range')", "t('fly.range' as never)"));
  });
}
