import { beforeEach, describe, expect, it } from 'vitest';

import {
  type Conditions,
  ManualControl,
  type ManualFields,
  manualFields,
  type Sticks,
  throttleKind,
} from './ManualControl';

const HELD: Sticks = { roll: 0.5, pitch: 1, throttle: 0, yaw: -0.25, buttons: 0, isHeld: true };
const LOOSE: Sticks = { ...HELD, isHeld: false };
const GOOD: Conditions = {
  isEnabled: true,
  isVisible: true,
  isLinked: true,
  system: 1,
  isHeard: true,
  throttle: 'centred',
};
const NEUTRAL = { x: 0, y: 0, z: 500, r: 0, buttons: 0 };

let sent: [number, ManualFields][];
let control: ManualControl;

beforeEach(() => {
  sent = [];
  control = new ManualControl((system, fields) => sent.push([system, fields]));
  control.tick(-20, LOOSE, GOOD);
});

describe('dead-man rule', () => {
  it('sends while the button is held, at every tick', () => {
    for (let time = 0; time < 1000; time += 20) control.tick(time, HELD, GOOD);
    expect(sent).toHaveLength(50);
    expect(sent[0]).toEqual([1, { x: 1000, y: 500, z: 500, r: -250, buttons: 0 }]);
    expect(control.state).toBe('active');
  });

  it('sends nothing before the button is pressed, and nothing when it is switched off', () => {
    control.tick(0, LOOSE, GOOD);
    expect(control.state).toBe('ready');
    control.tick(20, HELD, { ...GOOD, isEnabled: false });
    expect(control.state).toBe('off');
    expect(sent).toEqual([]);
  });

  it('centres the sticks when the button is released, and goes on when it is pressed again', () => {
    control.tick(0, HELD, GOOD);
    control.tick(20, LOOSE, GOOD);
    control.tick(40, LOOSE, GOOD);
    expect(sent.slice(1)).toEqual([
      [1, NEUTRAL],
      [1, NEUTRAL],
      [1, NEUTRAL],
    ]);
    expect([control.state, control.reason]).toEqual(['ready', 'released']);
    control.tick(60, HELD, GOOD);
    expect(control.state).toBe('active');
  });

  it.each([
    ['hidden', HELD, { ...GOOD, isVisible: false }, 3],
    ['link', HELD, { ...GOOD, isLinked: false }, 0],
    ['controller', null, GOOD, 3],
    ['vehicle', HELD, { ...GOOD, system: 2 }, 3],
    ['vehicle', HELD, { ...GOOD, system: null }, 3],
    ['contact', HELD, { ...GOOD, isHeard: false }, 3],
  ] as const)('stops when %s, and needs the button released first', (reason, sticks, conditions, neutrals) => {
    control.tick(0, HELD, GOOD);
    sent = [];
    control.tick(20, sticks, conditions);
    expect(sent).toEqual(Array(neutrals).fill([1, NEUTRAL]));
    expect([control.state, control.reason]).toEqual(['blocked', reason]);
    sent = [];
    control.tick(40, HELD, GOOD);
    control.tick(60, HELD, GOOD);
    expect(sent).toEqual([]);
    control.tick(80, LOOSE, GOOD);
    control.tick(100, HELD, GOOD);
    expect(sent).toHaveLength(1);
  });

  it('needs the button released after the controller was away, however long', () => {
    control.tick(0, HELD, GOOD);
    for (let time = 20; time < 200; time += 20) control.tick(time, null, GOOD);
    expect(control.reason).toBe('controller');
    sent = [];
    control.tick(200, HELD, GOOD);
    control.tick(220, HELD, GOOD);
    expect([sent, control.state, control.reason]).toEqual([[], 'blocked', 'released']);
    control.tick(240, LOOSE, GOOD);
    control.tick(260, HELD, GOOD);
    expect(control.state).toBe('active');
  });

  it('does not go on with old sticks after the page was frozen', () => {
    control.tick(0, HELD, GOOD);
    control.tick(900, HELD, GOOD);
    expect([control.state, control.reason]).toEqual(['blocked', 'frozen']);
  });

  it('stops at once, between two ticks', () => {
    control.halt('hidden');
    expect(sent).toEqual([]);
    control.tick(0, HELD, GOOD);
    control.halt('hidden');
    expect(sent.at(-1)).toEqual([1, NEUTRAL]);
    control.tick(20, HELD, GOOD);
    expect(control.state).toBe('blocked');
  });

  it('needs the button released when it is held already as steering is switched on', () => {
    control.tick(0, HELD, { ...GOOD, isEnabled: false });
    control.tick(20, HELD, GOOD);
    control.tick(40, HELD, GOOD);
    expect([sent, control.state]).toEqual([[], 'blocked']);
    control.tick(60, LOOSE, GOOD);
    control.tick(80, HELD, GOOD);
    expect(control.state).toBe('active');
    const fresh = new ManualControl((system, fields) => sent.push([system, fields]));
    sent = [];
    fresh.tick(0, HELD, GOOD);
    expect([sent, fresh.state]).toEqual([[], 'blocked']);
  });

  it('stops when it is switched off', () => {
    control.tick(0, HELD, GOOD);
    control.tick(20, HELD, { ...GOOD, isEnabled: false });
    expect(sent).toHaveLength(4);
    expect([control.state, control.reason]).toEqual(['off', null]);
  });
});

describe('throttle', () => {
  it('is counted as each firmware does', () => {
    expect(throttleKind('ardupilot', 'copter')).toBe('centred');
    expect(throttleKind('ardupilot', 'rover')).toBe('reverse');
    expect(throttleKind('px4', 'rover')).toBe('centred');
    expect(throttleKind('px4', 'plane')).toBe('forward');
    const up = { ...HELD, throttle: 1 };
    expect((['centred', 'reverse', 'forward'] as const).map((kind) => manualFields(up, kind).z)).toEqual([
      1000, 1000, 1000,
    ]);
    const down = { ...HELD, throttle: -1.2 };
    expect((['centred', 'reverse', 'forward'] as const).map((kind) => manualFields(down, kind).z)).toEqual([
      0, -1000, 0,
    ]);
  });

  it.each([
    ['reverse', 0],
    ['forward', 900],
  ] as const)('of kind %s is %i after the button is released', (throttle, z) => {
    control.tick(0, { ...HELD, throttle: 0.8 }, { ...GOOD, throttle });
    control.tick(20, LOOSE, { ...GOOD, throttle });
    expect(sent.at(-1)![1].z).toBe(z);
  });
});
