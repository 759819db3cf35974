import { expect, it } from 'vitest';

import { StationError } from '$lib/api/errors';

import { refusalsOf } from './actions.svelte';
import { course, flightReading, isUnderWay } from './reading';

it('tells which vehicles refused, with their reasons once', () => {
  const error = new StationError(
    'CommandDenied',
    'arming 2/1 failed: FAILED (PreArm: GPS)',
    ['PreArm: GPS', 'PreArm: RC', 'PreArm: RC'],
    4,
  );
  const refusals = refusalsOf(
    'Arm',
    [{ system: 1 }, { system: 2 }],
    [
      { status: 'fulfilled', value: undefined },
      { status: 'rejected', reason: error },
    ],
  );
  expect(refusals).toEqual([{ system: 2, action: 'Arm', text: error.message, reasons: ['PreArm: RC'] }]);
});

it('shows dashes without a vehicle, and no direction of travel for one that stands', () => {
  expect(flightReading(null)).toMatchObject({ roll: null, altitude: null, speed: null });
  expect(course({ velocity: { north: 0.1, east: 0.2, down: 0 } } as never)).toBeNull();
  expect(course({ velocity: { north: 0, east: -5, down: 0 } } as never)).toBe(270);
  expect(course({ velocity: null } as never)).toBeNull();
});

it('sends flying vehicles in the air only, others as soon as they are armed', () => {
  const state = (type: string, armed: boolean, inAir: boolean | null) => ({ type, armed, inAir }) as never;
  expect(
    [state('copter', true, true), state('copter', true, null), state('rover', true, false)].map(isUnderWay),
  ).toEqual([true, true, true]);
  expect([state('copter', true, false), state('rover', false, false)].map(isUnderWay)).toEqual([false, false]);
});
