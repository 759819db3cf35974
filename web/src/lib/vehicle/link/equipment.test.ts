import { describe, expect, it } from 'vitest';

import { equipmentCommand } from './equipment';

describe('equipment over USB', () => {
  it('sets servos, relays, grippers and winches by commands', () => {
    expect(equipmentCommand('servo', { servo: 9, pulse: 1700 })).toEqual({
      command: 'DO_SET_SERVO',
      params: [9, 1700],
    });
    expect(equipmentCommand('relay', { relay: 0, on: true })?.params).toEqual([0, 1]);
    expect(equipmentCommand('gripper', { open: true })?.params).toEqual([1, 0]);
    expect(equipmentCommand('winch', { length: -2 })?.params).toEqual([1, 1, -2, 0]);
    expect(equipmentCommand('commit-parameters', {})).toEqual({ command: 'PREFLIGHT_STORAGE', params: [1] });
    expect(equipmentCommand('transition', { to: 'fixed-wing' })?.params).toEqual([4]);
  });

  it('leaves all other actuators as they are', () => {
    expect(equipmentCommand('actuator', { actuator: 8, value: 0.5 })?.params).toEqual([
      null,
      0.5,
      null,
      null,
      null,
      null,
      1,
    ]);
  });

  it('leaves to the station what only it can do', () => {
    expect(equipmentCommand('beep', {})).toBeNull();
  });
});
