import { describe, expect, it } from 'vitest';
import { allowsArming, holdMode, landMode, startsByItself, waitingMode } from './modes';

describe('uses of modes', () => {
  it('come from the tables of the vehicle package', () => {
    const circling = { firmware: 'ardupilot', type: 'copter', mode: 'AVOID_ADSB' } as const;
    expect(allowsArming(circling)).toBe(false);
    expect(allowsArming({ ...circling, type: 'helicopter', mode: 'SYSTEMID' })).toBe(false);
    expect(allowsArming({ ...circling, mode: 'GUIDED' })).toBe(true);
    expect(allowsArming({ ...circling, mode: null })).toBe(true);
    expect(allowsArming({ firmware: 'px4', type: 'vtol', mode: 'FOLLOW_TARGET' })).toBe(false);
    expect(allowsArming({ firmware: 'ardupilot', type: 'blimp', mode: 'LAND' })).toBe(true);
    expect(startsByItself({ firmware: 'ardupilot', type: 'plane', mode: 'TAKEOFF' })).toBe(true);
    expect(startsByItself({ firmware: 'px4', type: 'copter', mode: 'LOITER' })).toBe(false);
  });

  it('have the names that the heartbeat stands for', () => {
    expect(waitingMode({ firmware: 'ardupilot', type: 'plane' })).toBe('FLY_BY_WIRE_A');
    expect(waitingMode({ firmware: 'px4', type: 'rover' })).toBe('LOITER');
    expect(waitingMode({ firmware: 'other', type: 'copter' })).toBe(null);
    expect(holdMode('ardupilot', 'helicopter')).toBe('BRAKE');
    expect(holdMode('px4', 'copter')).toBe('LOITER');
    expect(landMode('ardupilot', 'sub')).toBe('SURFACE');
    expect(landMode('ardupilot', 'vtol')).toBe('QLAND');
    expect(landMode('px4', 'copter')).toBe('LAND');
  });
});
