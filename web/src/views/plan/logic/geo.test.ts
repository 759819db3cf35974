import { describe, expect, it } from 'vitest';

import { area, bearing, contains, crossesItself, destination, distance } from './geo';

const HOME = { latitude: 47.397, longitude: 8.545 };
const square = [0, 90, 180, 270].map((heading) => destination(HOME, heading, 100));

describe('geometry', () => {
  it('finds a point by heading and distance, and back', () => {
    const point = destination(HOME, 60, 1234);
    expect(distance(HOME, point)).toBeCloseTo(1234, 6);
    expect(bearing(HOME, point)).toBeCloseTo(60, 6);
  });

  it('measures areas', () => {
    expect(area(square)).toBeCloseTo(20_000, -1);
  });

  it('tells points inside from those outside', () => {
    expect(contains(square, HOME)).toBe(true);
    expect(contains(square, destination(HOME, 45, 72))).toBe(false);
  });

  it('finds polygons whose edges cross', () => {
    expect(crossesItself(square)).toBe(false);
    expect(crossesItself([square[0]!, square[2]!, square[1]!, square[3]!])).toBe(true);
  });
});
