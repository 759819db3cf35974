import { expect, it, vi } from 'vitest';

import { api } from '$lib/api/client';

import { show } from './show.svelte';

async function begun(during: () => void): Promise<readonly unknown[]> {
  vi.spyOn(api, 'postBytes').mockResolvedValue({ tracks: [], problems: [] });
  vi.spyOn(api, 'get').mockResolvedValue({});
  const calls: unknown[] = [];
  vi.spyOn(api, 'longJson').mockImplementation(async (_method, path, _progress, _body, query) => {
    calls.push([path, query?.orientation]);
    if (path === 'swarm/takeoff') during();
    return {} as never;
  });
  await show.open(new File([], 'circle.skyc'));
  [show.systems, show.takeoff, show.orientation] = [[1, 2], true, 30];
  await show.fly(null);
  return calls;
}

it('flies as it was confirmed before the take-off', async () => {
  expect(await begun(() => (show.orientation = 90))).toEqual([
    ['swarm/takeoff', undefined],
    ['swarm/show', 30],
  ]);
});

it('does not start once it is closed', async () => {
  expect(await begun(() => show.close())).toEqual([['swarm/takeoff', undefined]]);
});
