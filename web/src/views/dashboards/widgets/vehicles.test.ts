import { afterEach, expect, it, vi } from 'vitest';

import { fleet } from '$lib/store/fleet.svelte';
import { parseFieldRef } from '$lib/series/fieldRef';

import type { Watched } from './reading.svelte';
import { stateOfSource, vehiclesOf } from './vehicles';

afterEach(() => void vi.restoreAllMocks());

const watch = (ref: string, value: number): Watched =>
  ({ field: { ref: parseFieldRef(ref)!, factor: 1, offset: 0 }, series: { value }, label: ref }) as unknown as Watched;

it('draws vehicles as what they are, and other sources as points', () => {
  const rover = { state: { type: 'rover', heading: 80 } } as never;
  vi.spyOn(fleet, 'vehicle').mockImplementation((system) => (system === 3 ? rover : null));
  const pair = (source: string) => [watch(`${source}:ROW.lat`, 47), watch(`${source}:ROW.lon`, 8)];
  const found = vehiclesOf(['3/1', '3', '4/1', 'cansat', 'script:3'].flatMap(pair));
  expect(found.map(({ type, heading }) => [type, heading])).toEqual([
    ['rover', 80],
    ['rover', 80],
    ['unknown', null],
    ['unknown', null],
    ['unknown', null],
  ]);
});

it('takes the selected vehicle for a source that may be any', () => {
  fleet.vehicles = [{ system: 5, state: { type: 'boat', heading: null } } as never];
  fleet.select(5);
  expect(stateOfSource('*')?.type).toBe('boat');
  fleet.vehicles = [];
});
