import { describe, expect, it } from 'vitest';

import { toDegrees, toMetres } from './localFrame';

describe('local frame', () => {
  it('has the metres of the ellipsoid, as mavstack.geodesy', () => {
    const [north, east] = toMetres({ latitude: 47, longitude: 8 }, { latitude: 47.01, longitude: 8.01 });
    expect(north).toBeCloseTo(1111.709, 3);
    expect(east).toBeCloseTo(760.489, 3);
  });

  it('goes back, also across the antimeridian', () => {
    const origin = { latitude: -17, longitude: 179.999 };
    const place = { latitude: -17.02, longitude: -179.99 };
    const back = toDegrees(origin, toMetres(origin, place));
    expect(back.latitude).toBeCloseTo(place.latitude, 9);
    expect(back.longitude).toBeCloseTo(place.longitude, 9);
    expect(toMetres(origin, place)[1]).toBeGreaterThan(0);
  });
});
