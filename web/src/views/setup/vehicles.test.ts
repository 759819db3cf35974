import { expect, it, vi } from 'vitest';

import { status } from '$lib/store/status.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { calibration } from './calibrationRun.svelte';
import { parameterSet } from './parameterSet.svelte';

function vehicle(values: object): Vehicle {
  const nothing = (): (() => void) => () => undefined;
  return { system: 1, state: { firmware: 'px4' }, onMessage: nothing, onStatusText: nothing, ...values } as unknown as Vehicle;
}

it('does not tell that a calibration was cancelled when the vehicle did not take it', async () => {
  status.source = 'demo';
  const sendCommand = vi.fn().mockResolvedValueOnce({}).mockRejectedValueOnce(new Error('no reply'));
  await calibration.start(vehicle({ sendCommand }), 'esc');
  expect(calibration.state).toBe('running');
  await calibration.cancel();
  expect([calibration.state, calibration.reasons]).toEqual(['failed', ['It could not be cancelled and may go on: no reply']]);
  calibration.reset();
  status.source = null;
});

it('shows no parameters of the vehicle before, for one that has none', async () => {
  const parameter = { name: 'RTL_ALT', value: 1, text: '1', type: 'REAL32' };
  const first = vehicle({ capabilities: { params: true }, getParameters: () => Promise.resolve([parameter]) });
  parameterSet.use(first);
  await vi.waitFor(() => expect(Object.keys(parameterSet.parameters)).toEqual(['RTL_ALT']));
  const getParameters = vi.fn();
  parameterSet.use(vehicle({ capabilities: { params: false }, getParameters }));
  expect([parameterSet.isEmpty, parameterSet.isLoading, getParameters.mock.calls]).toEqual([true, false, []]);
});
