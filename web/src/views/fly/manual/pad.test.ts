import { describe, expect, it } from 'vitest';

import { AxisCalibration, calibrated, NO_PROFILE, PadButtons } from './pad';
import { DEFAULT_MANUAL, padSticks } from './sticks';

const pad = (axes: number[], ...pressed: number[]) => ({
  axes,
  buttons: Array.from({ length: 17 }, (_, index) => ({ pressed: pressed.includes(index) })),
});
const LINEAR = { ...DEFAULT_MANUAL, deadZone: 0, expo: 0 };

describe('calibration', () => {
  it('finds centre and ends of the axes that moved to both sides', () => {
    const run = new AxisCalibration(pad([0.1, 0, -1, 0]));
    for (const axes of [
      [-0.7, 0.1, 1, NaN],
      [0.8, -0.1, 0, 0],
    ])
      run.sample(pad(axes));
    expect(run.ranges()).toEqual({ 0: { min: -0.7, centre: 0.1, max: 0.8 } });
  });

  it('makes the whole way of each side count', () => {
    const range = { min: -0.7, centre: 0.1, max: 0.8 };
    const ends = [-0.7, -0.3, 0.1, 0.45, 0.8, 0.9].map((value) => calibrated(value, range));
    expect(ends.map((value) => Math.round(value * 100) / 100)).toEqual([-1, -0.5, 0, 0.5, 1, 1]);
    expect(calibrated(0.4, undefined)).toBe(0.4);
    expect(calibrated(0.4, { min: 0, centre: 0, max: 0 })).toBe(0);
  });

  it('is part of the sticks, as other places of axes are', () => {
    const profile = { ...NO_PROFILE, ranges: { 5: { min: -0.5, centre: 0, max: 0.5 } }, places: { roll: 5 } };
    const sticks = padSticks(pad([0.1, 0, 0.9, 0, 0, 0.25]), LINEAR, false, profile);
    expect(sticks).toMatchObject({ yaw: 0.1, roll: 0.5 });
  });
});

describe('buttons', () => {
  const actions = { 1: 'rtl', 2: 'arm' } as const;

  it('act once for each press', () => {
    const buttons = new PadButtons();
    buttons.tick(0, pad([]), actions, 1);
    expect(buttons.tick(20, pad([], 1), actions, 1)).toEqual(['rtl']);
    expect(buttons.tick(40, pad([], 1), actions, 1)).toEqual([]);
    buttons.tick(60, pad([]), actions, 1);
    expect(buttons.tick(80, pad([], 1, 7), actions, 1)).toEqual(['rtl']);
  });

  it('that start motors must be held', () => {
    const buttons = new PadButtons();
    buttons.tick(0, pad([]), actions, 1);
    expect(buttons.tick(20, pad([], 2), actions, 1)).toEqual([]);
    expect(buttons.tick(900, pad([], 2), actions, 1)).toEqual([]);
    expect(buttons.tick(1020, pad([], 2), actions, 1)).toEqual(['arm']);
    expect(buttons.tick(5000, pad([], 2), actions, 1)).toEqual([]);
  });

  it('do nothing for a vehicle that was selected while they were held', () => {
    const buttons = new PadButtons();
    buttons.tick(0, pad([]), actions, 1);
    expect(buttons.tick(20, pad([], 2), actions, 1)).toEqual([]);
    expect(buttons.tick(900, pad([], 2), actions, 2)).toEqual([]);
    expect(buttons.tick(1900, pad([], 2), actions, 2)).toEqual([]);
    buttons.tick(1920, pad([]), actions, 2);
    expect(buttons.tick(1940, pad([], 1), actions, 2)).toEqual(['rtl']);
  });

  it('that are pressed at the start, or after the page was away, do nothing until they are released', () => {
    const buttons = new PadButtons();
    expect(buttons.tick(0, pad([], 1), actions, 1)).toEqual([]);
    expect(buttons.tick(20, pad([], 1), actions, 1)).toEqual([]);
    buttons.tick(40, pad([]), actions, 1);
    expect(buttons.tick(60, pad([], 1), actions, 1)).toEqual(['rtl']);
    buttons.clear();
    expect(buttons.tick(80, pad([], 1), actions, 1)).toEqual([]);
  });
});
