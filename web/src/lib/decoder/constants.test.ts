/** Numbers of MAVLink come from the generated enums: a copy of one would not follow a change of the definitions. */
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { describe, expect, it } from 'vitest';

import { enums } from '$generated';

const SOURCES = fileURLToPath(new URL('../..', import.meta.url));
/** `NAME = 1` and `NAME: 1`, also in hexadecimal and as a shift. */
const NUMBERED = /\b([A-Z][A-Z0-9_]{2,})\b(?:\s*=|:)\s*(0x[0-9a-f_]+|\d[\d_]*(?: << \d+)?)\b(?!\.)/gi;

/** Names of entries with their enum and number, such as `NAV_WAYPOINT 16`. */
const entries = new Map<string, string>();
for (const [name, values] of Object.entries(enums)) {
  for (const [entry, value] of Object.entries(values)) {
    for (const copy of [entry, `${name}_${entry}`]) entries.set(`${copy} ${Number(value)}`, name);
  }
}

function numberOf(text: string): number {
  const [value, shift] = text.replaceAll('_', '').split(' << ');
  return Number(value) * 2 ** Number(shift ?? 0);
}

function copiesIn(source: string): string[] {
  return [...source.matchAll(NUMBERED)]
    .filter(([, name]) => name === name!.toUpperCase())
    .map(([, name, value]) => [`${name} ${numberOf(value!)}`, `${name} = ${value}`] as const)
    .flatMap(([key, text]) => (entries.has(key) ? [`${text} (${entries.get(key)})`] : []));
}

const files = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' }).filter(
  (name) => /\.(ts|svelte)$/.test(name) && !name.startsWith('generated') && !name.endsWith('.test.ts'),
);

describe('numbers of MAVLink', () => {
  it('are found where they are copied', () => {
    expect(copiesIn('const NAV_WAYPOINT = 16;')).toEqual(['NAV_WAYPOINT = 16 (MAV_CMD)']);
    expect(copiesIn('{ DO_JUMP: 177, other: 3 }')).toEqual(['DO_JUMP = 177 (MAV_CMD)']);
    expect(copiesIn('const MAV_TYPE_GCS = 6;')).toEqual(['MAV_TYPE_GCS = 6 (MAV_TYPE)']);
    expect(copiesIn('export const MISSION = 1 << 2;')).toEqual([]);
    expect(copiesIn('export const FTP = 1 << 5;')).toEqual(['FTP = 1 << 5 (MAV_PROTOCOL_CAPABILITY)']);
    expect(copiesIn('const MARGIN = 16; const NAV_WAYPOINT = 17;')).toEqual([]);
  });

  it.each(files)('are not copied in %s', (name) => {
    expect(copiesIn(readFileSync(join(SOURCES, name), 'utf8'))).toEqual([]);
  });
});
