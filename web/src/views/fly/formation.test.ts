import { describe, expect, it } from 'vitest';

import { bearing, destination, distance } from '$lib/map/geometry';
import type { VehicleState, VehicleType } from '$lib/vehicle/Vehicle';

import { centreOf, conflictsOf, spotsOf } from './formation';

const MIDDLE = { latitude: 47, longitude: 8 };
const GOAL = destination(MIDDLE, 60, 400);

type Member = Pick<VehicleState, 'system' | 'type' | 'position'>;

function member(
  system: number,
  direction: number,
  metres: number,
  up: number,
  { type = 'copter' as VehicleType, home = 400 } = {},
): Member {
  const place = destination(MIDDLE, direction, metres);
  return { system, type, position: { ...place, altitude: home + up, relativeAltitude: up } };
}

describe('a group that is sent to a place', () => {
  const group = [member(1, 0, 20, 10), member(2, 120, 20, 12), member(3, 240, 20, 14)];

  it('keeps its formation around the place, and each its altitude', () => {
    expect(distance(centreOf(group)!, MIDDLE)).toBeLessThan(0.1);
    const spots = spotsOf(group, GOAL, { keepsFormation: true });
    spots.forEach(({ system, place, altitude }, index) => {
      expect([system, altitude]).toEqual([index + 1, undefined]);
      expect(distance(GOAL, place)).toBeCloseTo(20, 1);
      expect(bearing(GOAL, place)).toBeCloseTo(index * 120, 0);
    });
    expect(conflictsOf(group, spots)).toEqual([]);
  });

  it('goes to the place itself without a formation: those that have less than 5 m between them are told', () => {
    const spots = spotsOf(group, GOAL, { keepsFormation: false });
    expect(spots.map(({ place }) => place)).toEqual([GOAL, GOAL, GOAL]);
    const conflicts = conflictsOf(group, spots);
    expect(conflicts.map(({ systems }) => systems)).toEqual([
      [1, 2],
      [1, 3],
      [2, 3],
    ]);
    expect(conflicts[0]!.vertical).toBeCloseTo(2);
    const apart = [member(1, 0, 20, 10), member(2, 120, 20, 16)];
    expect(conflictsOf(apart, spotsOf(apart, GOAL, { keepsFormation: false }))).toEqual([]);
    const level = spotsOf(apart, GOAL, { keepsFormation: false, altitude: 30 });
    expect(conflictsOf(apart, level)).toHaveLength(1);
  });

  it('counts altitudes from the homes of the vehicles', () => {
    const homes = [member(1, 0, 2, 10), member(2, 180, 2, 10, { home: 420 })];
    expect(conflictsOf(homes, spotsOf(homes, GOAL, { keepsFormation: false, altitude: 30 }))).toEqual([]);
    const level = [member(1, 0, 2, 30), member(2, 180, 2, 10, { home: 420 })];
    expect(conflictsOf(level, spotsOf(level, GOAL, { keepsFormation: false }))).toHaveLength(1);
  });

  it('has circles of its planes one above the other, or apart', () => {
    const planes = (up: number): Member[] => [
      member(1, 0, 60, 60, { type: 'plane' }),
      member(2, 180, 60, up, { type: 'plane' }),
    ];
    const formation = { keepsFormation: true };
    expect(conflictsOf(planes(65), spotsOf(planes(65), GOAL, formation))).toHaveLength(1);
    expect(conflictsOf(planes(80), spotsOf(planes(80), GOAL, formation))).toEqual([]);
  });

  it('may have vehicles without a position', () => {
    const lost: Member = { system: 9, type: 'copter', position: null };
    expect(centreOf([lost])).toBeNull();
    const spots = spotsOf([lost, group[0]!], GOAL, { keepsFormation: true });
    expect(spots[0]!.place).toEqual(GOAL);
    expect(conflictsOf([lost, group[0]!], spots)[0]).toMatchObject({ systems: [9, 1], vertical: null });
  });
});
