import { describe, expect, it } from 'vitest';

import { destination } from '$lib/map/geometry';
import type { Aircraft } from '$lib/map/traffic';
import type { StatusText, VehicleState } from '$lib/vehicle/Vehicle';

import { alertsOf, armingProblems, modeObstacle } from './alerts';

const NOW = 1_790_000_000_000;
const PLACE = { latitude: 47, longitude: 8 };
const QUIET = {
  system: 1,
  alive: true,
  overdue: [],
  armed: true,
  inAir: true,
  systemStatus: 4,
  mode: 'AUTO',
  battery: null,
  fenceBreached: null,
  gps: { fix: 3 },
  estimator: null,
  vibration: null,
  statusTexts: [],
  conflict: null,
  position: { ...PLACE, altitude: 500, relativeAltitude: 50 },
} as unknown as VehicleState;

function found(changes: object, aircraft: readonly Aircraft[] = []): string[] {
  const alerts = alertsOf([{ ...QUIET, ...changes }], { now: NOW, aircraft }, 1);
  return alerts.map(({ text, isCritical }) => `${text.slice(9)}${isCritical ? '!' : ''}`);
}

const text = (words: string, severity = 2, age = 1000): StatusText => {
  return { system: 1, component: 1, severity, text: words, time: NOW - age };
};
const battery = (values: object): object => ({ battery: { cells: [], ...values } });

describe('alerts', () => {
  it('are none while all is well', () => {
    expect(found({})).toEqual([]);
    expect(found(battery({ remaining: 0.6 }))).toEqual([]);
  });

  it.each([
    ['a conflict of ids', { conflict: { text: '', senders: [], chosen: null } }, ['Conflict!']],
    [
      'a conflict of which one sender is chosen',
      { conflict: { text: '', senders: [], chosen: 'a' } },
      ['ConflictChosen'],
    ],
    ['a lost vehicle', { alive: false }, ['Lost!']],
    ['a lost vehicle that stands', { alive: false, armed: false }, ['Lost']],
    ['an attitude that ended', { overdue: ['attitude'] }, ['Silent!']],
    ['a battery that ended', { overdue: ['battery'] }, ['Silent']],
    ['an attitude that ended on the ground', { overdue: ['attitude'], inAir: false }, ['Silent']],
    ['a failsafe', { systemStatus: 5 }, ['Failsafe!']],
    ['no failsafe before the start', { systemStatus: 5, armed: false }, []],
    ['a terminated flight', { systemStatus: 8 }, ['Termination!']],
    ['a low battery', battery({ remaining: 0.25 }), ['BatteryLow']],
    ['a low battery on the ground, which is no news', { armed: false, ...battery({ remaining: 0.25 }) }, []],
    ['a critical battery, also on the ground', { armed: false, ...battery({ remaining: 0.1 }) }, ['BatteryCritical!']],
    ['a battery that the vehicle calls low', battery({ remaining: 0.5, chargeState: 2 }), ['BatteryLow']],
    ['a battery that the vehicle calls critical', battery({ remaining: 0.5, chargeState: 3 }), ['BatteryCritical!']],
    ['a battery that is charged', battery({ remaining: 0.5, chargeState: 7 }), []],
    ['its weakest cell', battery({ remaining: null, cells: [3.9, 3.3] }), ['BatteryCritical!']],
    ['a breached fence', { fenceBreached: true }, ['Fence!']],
    ['a lost GPS', { gps: { fix: 1 } }, ['Gps!']],
    ['no GPS before the start', { gps: { fix: 1 }, armed: false }, []],
    ['a bad estimate', { estimator: { ratio: 1.2, isInitialized: true } }, ['Estimator!']],
    ['strong vibrations', { vibration: { level: 45 } }, ['Vibration']],
    ['very strong vibrations', { vibration: { level: 70 } }, ['Vibration!']],
    ['a critical text', { statusTexts: [text('Fence Breached'), text('Mission: 2 WP', 6)] }, ['Text!']],
    ['no old text', { statusTexts: [text('Fence Breached', 2, 16_000)] }, []],
    ['no failed checks, which are shown beside the arming button', { statusTexts: [text('PreArm: Compass')] }, []],
  ])('tell %s', (_, changes, expected) => {
    expect(found(changes)).toEqual(expected);
  });

  it('tell traffic that is near in both directions', () => {
    const at = (metres: number, altitude: number | null, age = 0): Aircraft =>
      ({ ...destination(PLACE, 90, metres), altitude, callsign: 'HB-ABC', time: NOW - age }) as Aircraft;
    expect(found({}, [at(1500, 700)])).toEqual(['TrafficAbove']);
    expect(found({}, [at(1500, 700), at(400, 450)])).toEqual(['TrafficBelow!']);
    expect(found({}, [at(400, null)])).toEqual(['TrafficAbove!']);
    expect(found({}, [at(2500, 500), at(400, 900), at(100, 500, 20_000)])).toEqual([]);
    expect(found({ armed: false }, [at(100, 500)])).toEqual([]);
  });

  it('come in the order of their weight, those of the selected vehicle first', () => {
    const states = [
      { ...QUIET, system: 1, vibration: { level: 45 } },
      { ...QUIET, system: 2, vibration: { level: 45 } },
      { ...QUIET, system: 3, fenceBreached: true },
    ] as unknown as VehicleState[];
    const order = alertsOf(states, { now: NOW, aircraft: [] }, 2).map(({ system }) => system);
    expect(order).toEqual([3, 2, 1]);
  });
});

it('tells the failed checks of the last run only, each once, as long as they are true', () => {
  const texts = [
    text('PreArm: RC not found', 2, 35_000),
    text('PreArm: GPS 1: no fix', 2, 6000),
    text('PreArm: Compass', 2, 5000),
    text('PreArm: Compass', 2, 4500),
    text('Mode GUIDED', 6, 1000),
  ];
  expect(armingProblems(texts, NOW)).toEqual(['GPS 1: no fix', 'Compass']);
  expect(armingProblems(texts, NOW + 41_000)).toEqual([]);
  expect(armingProblems([], NOW)).toEqual([]);
});

it('tells what the mode of a vehicle means for arming', () => {
  const words = (firmware: VehicleState['firmware'], type: VehicleState['type'], mode: string | null) =>
    modeObstacle({ firmware, type, mode });
  expect(words('ardupilot', 'copter', 'RTL')).toBe('Does not arm in RTL; arming changes to GUIDED');
  expect(words('px4', 'copter', 'LAND')).toBe('Does not arm in LAND; arming changes to LOITER');
  expect(words('ardupilot', 'plane', 'TAKEOFF')).toBe('Would start by itself in TAKEOFF: change the mode to arm');
  for (const mode of ['GUIDED', 'STABILIZE', null]) expect(words('ardupilot', 'copter', mode)).toBeNull();
  expect([
    words('msp', 'copter', 'LAND'),
    words('other', 'plane', 'RTL'),
    words('ardupilot', 'sub', 'SURFACE'),
  ]).toEqual([null, null, null]);
});
