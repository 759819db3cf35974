import { describe, expect, it } from 'vitest';

import { failureParams, unitName } from './failures';

describe('failures on purpose', () => {
  it('are named for people', () => {
    expect([unitName('SENSOR_OPTICAL_FLOW'), unitName('SYSTEM_RC_SIGNAL')]).toEqual(['optical flow', 'rc signal']);
  });

  it('have the numbers of the definition', () => {
    expect(failureParams('SYSTEM_MOTOR', 'OFF', 2)).toEqual([101, 1, 2]);
    expect(failureParams('SENSOR_GPS', 'OK', 0)).toEqual([4, 0, 0]);
  });
});
