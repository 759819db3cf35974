import { describe, expect, it } from 'vitest';

import { DEFAULT_MANUAL, KeySticks, padSticks, shaped, TouchSticks } from './sticks';

const pad = (axes: number[], ...pressed: number[]) => ({
  axes,
  buttons: Array.from({ length: 17 }, (_, index) => ({ pressed: pressed.includes(index) })),
});
const LINEAR = { ...DEFAULT_MANUAL, deadZone: 0, expo: 0 };

describe('gamepad', () => {
  it('has a dead zone, full ends, and a fine centre', () => {
    expect(shaped(0.07, 0.08, 0.3)).toBe(0);
    expect(shaped(1, 0.08, 0.3)).toBe(1);
    expect(shaped(-1.1, 0.08, 0.3)).toBe(-1);
    expect(shaped(0.5, 0, 1)).toBe(0.125);
    expect(shaped(NaN, 0.08, 0)).toBe(0);
  });

  it('flies in the mode that the pilot has learnt', () => {
    const axes = [0.1, -0.2, 0.3, -0.4];
    expect(padSticks(pad(axes), LINEAR)).toMatchObject({ yaw: 0.1, throttle: 0.2, roll: 0.3, pitch: 0.4 });
    expect(padSticks(pad(axes), { ...LINEAR, mode: 1 })).toMatchObject({
      yaw: 0.1,
      pitch: 0.2,
      roll: 0.3,
      throttle: 0.4,
    });
    expect(padSticks(pad(axes), { ...LINEAR, mode: 3 })).toMatchObject({
      roll: 0.1,
      pitch: 0.2,
      yaw: 0.3,
      throttle: 0.4,
    });
    expect(padSticks(pad(axes), { ...LINEAR, mode: 4, inverted: ['yaw'] })).toMatchObject({ roll: 0.1, yaw: -0.3 });
  });

  it('holds by its dead-man button, which is no button of the vehicle', () => {
    expect(padSticks(pad([0, 0, 0, 0], 3), LINEAR).isHeld).toBe(false);
    const held = padSticks(pad([0, 0, 0, 0], 4, 0, 9), LINEAR, true);
    expect([held.isHeld, held.buttons]).toEqual([true, 1 | (1 << 9)]);
    expect(padSticks(pad([0, 0, 0, 0], 4, 0), LINEAR).buttons).toBe(0);
  });

  it('survives a controller with fewer axes and buttons', () => {
    expect(padSticks({ axes: [], buttons: [] }, LINEAR)).toMatchObject({ roll: 0, throttle: 0, isHeld: false });
  });
});

describe('keyboard', () => {
  it('ramps up, springs back at once, and is held by the space bar', () => {
    const keys = new KeySticks();
    keys.read(0);
    keys.press('ArrowUp');
    expect(keys.read(50).pitch).toBeCloseTo(0.1);
    expect(keys.read(500).pitch).toBeCloseTo(0.5);
    keys.release('ArrowUp');
    expect(keys.read(520).pitch).toBe(0);
    keys.press('Space');
    expect(keys.read(540).isHeld).toBe(true);
    keys.clear();
    expect(keys.read(560)).toMatchObject({ isHeld: false, pitch: 0 });
  });

  it.each([
    ['KeyW', 'throttle', 0.5],
    ['KeyS', 'throttle', -0.5],
    ['KeyA', 'yaw', -0.5],
    ['KeyD', 'yaw', 0.5],
    ['ArrowUp', 'pitch', 0.5],
    ['ArrowDown', 'pitch', -0.5],
    ['ArrowLeft', 'roll', -0.5],
    ['ArrowRight', 'roll', 0.5],
  ] as const)('%s moves %s by %d', (code, axis, expected) => {
    const keys = new KeySticks();
    keys.read(0);
    keys.press(code);
    const centred = { roll: 0, pitch: 0, throttle: 0, yaw: 0 };
    expect(keys.read(1000)).toMatchObject({ ...centred, [axis]: expected });
  });

  it('cancels opposite keys', () => {
    const keys = new KeySticks();
    keys.press('KeyA');
    keys.press('KeyD');
    keys.read(0);
    expect(keys.read(500).yaw).toBe(0);
  });
});

it('touch sticks are held while a finger is on one of them', () => {
  const sticks = new TouchSticks();
  expect(sticks.read().isHeld).toBe(false);
  sticks.set('left', [0.2, 0.6]);
  expect(sticks.read()).toMatchObject({ yaw: 0.2, throttle: 0.6, roll: 0, isHeld: true });
  sticks.set('right', [1, 1]);
  sticks.clear();
  expect(sticks.read()).toMatchObject({ roll: 0, pitch: 0, yaw: 0, isHeld: false });
  sticks.set('left', [0.2, 0.6]);
  sticks.set('left', null);
  expect(sticks.read()).toMatchObject({ throttle: 0, isHeld: false });
});
