import { expect, test } from 'vitest';

import { UNKNOWN_CAPABILITIES } from './capabilities';

/** The modules of views and shell, which show a panel or a button if a vehicle has what it needs. */
const MODULES = import.meta.glob<string>(['/src/views/**/*.{ts,svelte}', '/src/shell/*.svelte', '!**/*.test.ts'], {
  query: '?raw',
  import: 'default',
  eager: true,
});

test('each capability is read by a view', () => {
  const source = Object.values(MODULES).join('\n');
  const isRead = (name: string): boolean => new RegExp(`(\\bcapabilities\\??\\.|\\bcan\\.|')${name}\\b`).test(source);
  expect(Object.keys(UNKNOWN_CAPABILITIES).filter((name) => !isRead(name))).toEqual([]);
});
