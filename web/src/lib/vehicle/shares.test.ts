import { expect, it, vi } from 'vitest';

import { fleet } from '$lib/store/fleet.svelte';

import { uploadShares, type Share } from './shares';
import type { Vehicle } from './Vehicle';

it('are uploaded to their vehicles, and no armed vehicle starts its mission', async () => {
  const uploadPlan = vi.fn(async () => undefined);
  const startMission = vi.fn();
  const vehicle = { state: { armed: true }, uploadPlan, startMission } as unknown as Vehicle;
  vi.spyOn(fleet, 'vehicle').mockImplementation((system) => (system === 2 ? vehicle : undefined) as never);
  const items = [{ command: 16 }];
  const shares = [1, 2, null].map((system) => ({ system, items })) as unknown as readonly Share[];
  expect(await uploadShares(shares)).toEqual([vehicle]);
  expect(uploadPlan.mock.calls).toEqual([['mission', { items, home: null }]]);
  expect(startMission).not.toHaveBeenCalled();
});
