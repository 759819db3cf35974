import { expect, it } from 'vitest';

import { StationError } from '$lib/api/errors';
import { fleet } from '$lib/store/fleet.svelte';

import { actions, refusalsOf } from './actions.svelte';
import { fly } from './fly.svelte';
import { measuredText } from './layers';
import { course, flightReading, IS_FOR, isUnderWay } from './reading';

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
  expect(refusals).toEqual([{ system: 2, action: 'Arm', text: error.message, reasons: ['PreArm: RC'], run: 0 }]);
});

it('keeps the refusal of a later action when an earlier one is answered late', async () => {
  const vehicle = { system: 1 } as never;
  let answer = (): void => undefined;
  const slow = actions.run('Go here', [vehicle], () => new Promise<void>((resolve) => (answer = resolve)));
  await actions.run('Land', [vehicle], () => Promise.reject(new StationError('CommandDenied', 'landing failed')));
  answer();
  await slow;
  expect(actions.refusals.map(({ action }) => action)).toEqual(['Land']);
  await actions.run('Hold', [vehicle], () => Promise.resolve());
  expect(actions.refusals).toEqual([]);
});

it('does not call an action refused that the pilot replaced', () => {
  const replaced = {
    status: 'rejected' as const,
    reason: new StationError('Cancelled', 'a later command replaced it'),
  };
  expect(refusalsOf('Arm', [{ system: 1 }], [replaced])).toEqual([]);
});

it('shows a target until the vehicle gets something else to do', () => {
  const spot = (system: number) => ({ system, place: { latitude: 47, longitude: 8 }, altitude: undefined });
  fly.target = { spots: [spot(1), spot(2)], radius: null };
  fly.dropTargets([2, 3]);
  expect(fly.target?.spots.map(({ system }) => system)).toEqual([1]);
  fly.dropTargets([1]);
  expect(fly.target).toBeNull();
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

it('sends an action to those of several vehicles that can do it', () => {
  const vehicle = (armed: boolean, inAir: boolean | null, type = 'copter', orbit: boolean | null = null) =>
    ({
      state: { type, armed, inAir, alive: true },
      capabilities: { takeoff: null, goto: true, orbit, mission: true },
    }) as never;
  const chosen = [
    vehicle(false, false),
    vehicle(true, false),
    vehicle(true, true),
    vehicle(true, null),
    vehicle(true, false, 'rover', false),
  ];
  const numbers = (action: keyof typeof IS_FOR) =>
    chosen.flatMap((each, index) => (IS_FOR[action](each) ? [index] : []));
  expect(numbers('arm')).toEqual([0]);
  expect(numbers('disarm')).toEqual([1, 3, 4]);
  expect(numbers('takeoff')).toEqual([1, 3]);
  expect(numbers('goto')).toEqual([2, 3, 4]);
  expect(numbers('orbit')).toEqual([2, 3]);
  expect(numbers('armed')).toEqual([1, 2, 3, 4]);
  // The mission arms those that are not.
  expect(numbers('mission')).toEqual([0, 1, 2, 3, 4]);
});

it('measures distance and bearing', () => {
  const from = { latitude: 47, longitude: 8 };
  expect(measuredText({ from, to: null })).toBe('');
  expect(measuredText({ from, to: { latitude: 47.001, longitude: 8 } })).toBe('111 m · 000°');
  expect(measuredText({ from, to: { latitude: 47, longitude: 7.999 } })).toBe('76 m · 270°');
});

it('keeps a choice whose vehicles are away from falling back to the selected vehicle', () => {
  const vehicle = (system: number) => ({ system }) as never;
  fleet.vehicles = [vehicle(1), vehicle(2)];
  fleet.select(1);
  expect(fly.targets.map(({ system }) => system)).toEqual([1]);
  fly.chosen = [2, 7];
  expect(fly.targets.map(({ system }) => system)).toEqual([2]);
  fly.chosen = [7];
  expect([fly.targets, fly.targetKey]).toEqual([[], '']);
  fly.chosen = [];
  fleet.vehicles = [];
});

it('keeps the newest 500 aircraft', () => {
  const report = (address: number) => fly.takeTraffic({ address, latitude: 0, longitude: 0 } as never);
  for (let address = 1; address <= 500; address += 1) report(address);
  report(1);
  report(501);
  expect([fly.aircraft.length, fly.aircraft[0]!.address, fly.aircraft.at(-2)!.address]).toEqual([500, 3, 1]);
});
