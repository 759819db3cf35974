import { describe, expect, it } from 'vitest';

import { Ring } from '$lib/plot/Ring';

import { eulerOf, followingOf, tuningSample } from './tuning';

const HALF = Math.SQRT1_2;

describe('samples of tuning', () => {
  it('have the rates of ATTITUDE_TARGET and ATTITUDE in degrees per second', () => {
    const target = { type_mask: 0, body_roll_rate: Math.PI / 2, body_pitch_rate: 0, body_yaw_rate: 0, q: [1, 0, 0, 0] };
    expect(tuningSample('ATTITUDE_TARGET', target, 'roll', 'rate')).toEqual({ setpoint: 90 });
    expect(tuningSample('ATTITUDE_TARGET', { ...target, type_mask: 1 }, 'roll', 'rate')).toEqual({});
    expect(tuningSample('ATTITUDE', { rollspeed: Math.PI }, 'roll', 'rate')).toEqual({ response: 180 });
  });

  it('have angles from the quaternion, and those of a plane', () => {
    expect(eulerOf([HALF, HALF, 0, 0]).roll).toBeCloseTo(Math.PI / 2);
    expect(eulerOf([HALF, 0, 0, HALF]).yaw).toBeCloseTo(Math.PI / 2);
    expect(tuningSample('ATTITUDE_TARGET', { type_mask: 128, q: [1, 0, 0, 0] }, 'roll', 'angle')).toEqual({});
    expect(tuningSample('NAV_CONTROLLER_OUTPUT', { nav_roll: 12 }, 'roll', 'angle')).toEqual({ setpoint: 12 });
    expect(tuningSample('NAV_CONTROLLER_OUTPUT', { nav_roll: 12 }, 'roll', 'rate')).toEqual({});
  });

  it('have both sides of PID_TUNING for its axis only', () => {
    const fields = { axis: 2, desired: 10, achieved: 8 };
    expect(tuningSample('PID_TUNING', fields, 'pitch', 'rate')).toEqual({ setpoint: 10, response: 8 });
    expect(tuningSample('PID_TUNING', fields, 'roll', 'rate')).toEqual({});
  });
});

describe('following', () => {
  it('finds the delay of a response', () => {
    const [setpoints, responses] = [new Ring(500), new Ring(500)];
    for (let time = 0; time < 5000; time += 20) {
      setpoints.push(time, Math.sin(time / 200));
      responses.push(time, Math.sin((time - 120) / 200));
    }
    expect(followingOf(setpoints, responses)?.delay).toBe(120);
    expect(followingOf(setpoints, responses)?.error).toBeGreaterThan(0.3);
  });

  it('says nothing of few values', () => {
    expect(followingOf(new Ring(10), new Ring(10))).toBeNull();
  });
});
