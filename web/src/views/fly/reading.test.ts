import { describe, expect, it } from 'vitest';

import type { VehicleState } from '$lib/vehicle/Vehicle';

import { flightReading } from './reading';

const STATE = {
  type: 'plane',
  overdue: [],
  roll: 1,
  pitch: 2,
  heading: 3,
  groundSpeed: 20,
  airSpeed: 18,
  climbRate: 1,
  velocity: { north: 10, east: 0, down: 0 },
  position: { latitude: 47, longitude: 8, altitude: 500, relativeAltitude: 50 },
  home: null,
} as unknown as VehicleState;

describe('the flight display', () => {
  it('shows all values while they arrive', () => {
    const shown = flightReading(STATE);
    expect(shown).toMatchObject({ roll: 1, pitch: 2, heading: 3, course: 0, speed: 18, altitude: 50, climb: 1 });
  });

  it.each([
    ['attitude', { roll: null, pitch: null, heading: null, altitude: 50, speed: 18 }],
    ['position', { altitude: null, course: null, roll: 1 }],
    ['airspeed', { speed: null, altitude: 50, climb: 1 }],
    ['speed', { climb: null, roll: 1 }],
  ])('shows no values of a stream that ended: %s', (stream, values) => {
    expect(flightReading({ ...STATE, overdue: [stream] } as unknown as VehicleState)).toMatchObject(values);
  });
});
