import { expect, it } from 'vitest';

import { isInAir } from './inAir';

type Evidence = Parameters<typeof isInAir>[0];
const STANDBY = 3;
const ACTIVE = 4;
const CRITICAL = 5;

const PLANE: Evidence = {
  type: 'plane',
  firmware: 'ardupilot',
  armed: true,
  systemStatus: STANDBY,
  landedState: null,
  position: null,
  airSpeed: 0.4,
  groundSpeed: 0.1,
  climbRate: 0,
  throttle: 0,
};
const at = (relativeAltitude: number) => ({ latitude: 47, longitude: 8, altitude: 500, relativeAltitude });
const found = (changes: Partial<Evidence>, age = Infinity): boolean | null => isInAir({ ...PLANE, ...changes }, age);

it('believes a fresh landed state, and an old one where nothing else tells', () => {
  expect([found({ landedState: 1 }, 0), found({ landedState: 2 }, 0)]).toEqual([false, true]);
  expect(found({ landedState: 1, systemStatus: ACTIVE }, 60_000)).toBe(true);
  expect(found({ firmware: 'px4', landedState: 1 }, 60_000)).toBe(false);
});

it('knows from the heartbeat of ArduPilot, or from its motion, that a plane without a landed state flies', () => {
  expect(found({ systemStatus: ACTIVE })).toBe(true);
  expect(found({ airSpeed: 22, groundSpeed: 20, position: at(60), throttle: 0.5 })).toBe(true);
  expect(found({ systemStatus: CRITICAL, groundSpeed: 18, position: at(40) })).toBe(true);
  expect(found({ systemStatus: CRITICAL, airSpeed: 15, climbRate: 3, position: at(2) })).toBe(true);
});

it('does not take taxiing, or a failsafe on the ground, for flying', () => {
  expect(found({ groundSpeed: 9, airSpeed: 9, throttle: 0.3, position: at(0.3) })).toBe(false);
  expect(found({ systemStatus: CRITICAL })).toBeNull();
  expect(found({ armed: false, systemStatus: ACTIVE })).toBe(false);
});

it('knows of hovering at a height, of vehicles that never fly, and of other firmwares by motion only', () => {
  const hovering = { type: 'copter', systemStatus: CRITICAL, position: at(12), throttle: 0.4 } as const;
  expect(found(hovering)).toBe(true);
  expect(found({ type: 'rover', systemStatus: ACTIVE, groundSpeed: 12, position: at(487.9) })).toBe(false);
  expect([found({ ...hovering, firmware: 'other' }), found({ firmware: 'other' })]).toEqual([true, null]);
});
