import { describe, expect, it } from 'vitest';

import type { VehicleState } from '$lib/vehicle/Vehicle';

import { automaticChecks, manualChecks } from './checks';

const GOOD = {
  type: 'copter',
  alive: true,
  loss: 0,
  ready: true,
  gps: { fix: 3, satellites: 12 },
  home: {},
  battery: { remaining: 0.9 },
  estimator: { ratio: 0.2 },
  rc: { channels: [], rssi: 0.9 },
  fenceBreached: false,
  conflict: null,
} as unknown as VehicleState;

const states = (changed: Partial<Record<keyof VehicleState, unknown>>): Record<string, string> =>
  Object.fromEntries(
    automaticChecks({ ...GOOD, ...changed } as VehicleState).map(({ key, state }) => [key.split('.')[1], state]),
  );

describe('automatic checks', () => {
  it('are all good for a vehicle that is ready', () => {
    expect(new Set(Object.values(states({})))).toEqual(new Set(['ok']));
  });

  it('name each fault', () => {
    const faults: readonly [string, Partial<Record<keyof VehicleState, unknown>>][] = [
      ['link', { alive: false }],
      ['link', { alive: false, loss: null }],
      ['link', { loss: 0.4 }],
      ['ready', { ready: false }],
      ['gps', { gps: { fix: 2, satellites: 12 } }],
      ['gps', { gps: { fix: 3, satellites: 4 } }],
      ['battery', { battery: { remaining: 0.3 } }],
      ['estimate', { estimator: { ratio: 0.95 } }],
      ['remote', { rc: { channels: [], rssi: 0.1 } }],
      ['fence', { fenceBreached: true }],
      ['id', { conflict: {} }],
    ];
    for (const [key, changed] of faults) {
      const found = Object.entries(states(changed)).filter(([, state]) => state === 'bad');
      expect(found.map(([name]) => name)).toEqual([key]);
    }
  });

  it('are unknown where the vehicle does not report', () => {
    const found = states({ gps: null, battery: null, rc: null, fenceBreached: null, home: null });
    expect(found).toMatchObject({
      gps: 'unknown',
      battery: 'unknown',
      remote: 'unknown',
      fence: 'unknown',
      link: 'ok',
    });
    expect('gps' in states({ type: 'sub' })).toBe(false);
  });
});

describe('items that a pilot ticks', () => {
  it('belong to the type of the vehicle', () => {
    expect(manualChecks('copter')).toContain('preflight.propellers');
    expect(manualChecks('plane')).toContain('preflight.surfaces');
    expect(manualChecks('sub')).toContain('preflight.seals');
    expect(manualChecks('unknown').length).toBe(4);
  });
});
