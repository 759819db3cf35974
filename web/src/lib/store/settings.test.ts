import { afterEach, expect, it, vi } from 'vitest';

import { Persisted } from './settings.svelte';

afterEach(() => vi.unstubAllGlobals());

it.each([
  ['"imperial"', 'imperial'],
  ['"furlongs"', 'metric'],
  ['{broken', 'metric'],
  [null, 'metric'],
])('a stored value %s is read as %s', (text, value) => {
  vi.stubGlobal('localStorage', { getItem: () => text });
  expect(new Persisted<string>('units', 'metric', ['metric', 'imperial']).value).toBe(value);
});
