import { MavCmd } from '$generated';

import { describe, expect, it } from 'vitest';

import { area, bearing, contains, destination, distance, pathLength } from './geo';
import { corridorLanes, corridorOutline } from './corridor';
import { altitudeFor, CAMERAS, laneItems, pictureCount, spacingOf } from './pattern';
import { fewestLanesAngle, surveyLanes } from './survey';

const HOME = { latitude: 47.397, longitude: 8.545 };
const corner = (east: number, north: number) => destination(destination(HOME, 90, east), 0, north);
const field = [corner(0, 0), corner(200, 0), corner(200, 100), corner(0, 100)];

describe('survey', () => {
  it('covers a rectangle with lanes at their distance, there and back', () => {
    // The map is a globe, the planner's Earth an ellipsoid: there the field is a little wider than 200 m.
    const lanes = surveyLanes(field, { spacing: 25.1, angle: 0 });
    expect(lanes).toHaveLength(8);
    for (const lane of lanes) expect(pathLength(lane)).toBeCloseTo(100, 0);
    expect(distance(lanes[0]![1]!, lanes[1]![0]!)).toBeCloseTo(25, 1);
    expect(bearing(lanes[0]![0]!, lanes[0]![1]!)).toBeCloseTo(0, 1);
    expect(bearing(lanes[1]![0]!, lanes[1]![1]!)).toBeCloseTo(180, 1);
  });

  it('turns lanes by their angle', () => {
    const lanes = surveyLanes(field, { spacing: 25, angle: 90 });
    expect(lanes).toHaveLength(4);
    expect(pathLength(lanes[0]!)).toBeCloseTo(200, 0);
    expect(fewestLanesAngle(field)).toBe(90);
  });

  it('stays in a concave area, within half a lane of its corners', () => {
    const bay = [corner(0, 0), corner(200, 0), corner(200, 100), corner(100, 40), corner(0, 100)];
    const lanes = surveyLanes(bay, { spacing: 10, angle: 90 });
    expect(lanes.length).toBeGreaterThan(10);
    for (const [from, to] of lanes) {
      const middle = {
        latitude: (from!.latitude + to!.latitude) / 2,
        longitude: (from!.longitude + to!.longitude) / 2,
      };
      expect(contains(bay, middle) || contains(bay, destination(middle, 180, 5))).toBe(true);
    }
  });

  it('has a second pass across, other corners, and no lanes for what is impossible', () => {
    const once = surveyLanes(field, { spacing: 25.1, angle: 0 });
    expect(surveyLanes(field, { spacing: 25.1, angle: 0, crosshatch: true })).toHaveLength(8 + 4);
    const starts = [0, 1, 2, 3].map((start) => surveyLanes(field, { spacing: 25.1, angle: 0, start })[0]![0]!);
    expect(new Set(starts.map((each) => `${each.latitude.toFixed(6)} ${each.longitude.toFixed(6)}`)).size).toBe(4);
    expect(once[0]![0]).toEqual(starts[0]);
    const across = [corner(0, 0), corner(2, 0), corner(2, 30_000), corner(0, 30_000)];
    expect(surveyLanes(across, { spacing: 25, angle: 0 })).toHaveLength(1);
    // A pass across with too many lanes: neither half is what was asked for.
    expect(surveyLanes(across, { spacing: 25, angle: 0, crosshatch: true })).toEqual([]);
    for (const spacing of [0, -1, NaN, 0.01]) expect(surveyLanes(field, { spacing, angle: 0 })).toEqual([]);
  });
});

describe('corridor', () => {
  const line = [corner(0, 0), corner(300, 0), corner(300, 300)];

  it('has parallel lanes that keep their distance around corners', () => {
    const lanes = corridorLanes(line, { width: 60, spacing: 30 });
    expect(lanes).toHaveLength(2);
    expect(distance(lanes[0]![0]!, lanes[1]!.at(-1)!)).toBeCloseTo(30, 1);
    const lengths = lanes.map((lane) => pathLength(lane)).sort((a, b) => a - b);
    expect(lengths[1]! - lengths[0]!).toBeCloseTo(60, 0);
    expect(area(corridorOutline(line, 60)) / (600 * 60)).toBeCloseTo(1, 2);
  });
});

describe('lanes that are difficult', () => {
  it('cross the antimeridian', () => {
    const at = (east: number, north: number) =>
      destination(destination({ latitude: 10, longitude: 179.9995 }, 90, east), 0, north);
    const lanes = surveyLanes([at(0, 0), at(200, 0), at(200, 100), at(0, 100)], { spacing: 25, angle: 90 });
    expect(lanes).toHaveLength(4);
    for (const [from, to] of lanes) {
      expect(distance(from!, to!)).toBeCloseTo(200, 0);
      expect(Math.sign(from!.longitude)).toBe(-Math.sign(to!.longitude));
    }
  });

  it('have a length: a corner that a lane only touches gives none', () => {
    const notch = [corner(0, 0), corner(200, 0), corner(200, 100), corner(100, 50), corner(0, 100)];
    const lanes = [1, 3, 5, 7, 9].flatMap((spacing) => surveyLanes(notch, { spacing, angle: 90 }));
    for (const lane of lanes) expect(pathLength(lane)).toBeGreaterThan(0.005);
    expect(surveyLanes([corner(0, 0), corner(50, 0), corner(100, 0)], { spacing: 5, angle: 0 }).flat()).toEqual([]);
  });

  it('of a corridor do not depend on points that were clicked twice', () => {
    const bend = [corner(0, 0), corner(300, 0), corner(300, 300)];
    const doubled = bend.flatMap((each) => [each, each]);
    expect(corridorLanes(doubled, { width: 60, spacing: 30 })).toEqual(corridorLanes(bend, { width: 60, spacing: 30 }));
    expect(corridorLanes([bend[0]!, bend[0]!], { width: 60, spacing: 30 })).toEqual([]);
  });

  it.each([
    [40, 250],
    [12, 100],
  ])('of a corridor stay near a bend that is sharp (%i, %i)', (east, north) => {
    const sharp = [corner(0, 0), corner(0, 300), corner(east, north)];
    for (const lane of corridorLanes(sharp, { width: 120, spacing: 20 })) {
      for (const each of lane) expect(Math.min(...sharp.map((point) => distance(point, each)))).toBeLessThan(3 * 60);
      // The inner side of the bend does not fly beyond the short end.
      expect(Math.max(...lane.map((each) => each.latitude))).toBeLessThan(corner(0, 300 + 3 * 60).latitude);
    }
    const inner = corridorLanes(sharp, { width: 120, spacing: 20 }).map((lane) =>
      Math.min(...lane.map((each) => distance(sharp[1]!, each))),
    );
    expect(Math.max(...inner)).toBeLessThan(3 * 60);
  });
});

describe('camera', () => {
  it('gives the distances of lanes and pictures from overlap', () => {
    const camera = CAMERAS[0]!;
    const spacing = spacingOf(camera, 70, { side: 70, front: 80 });
    expect(spacing.footprint.across).toBeCloseTo(71.8, 1);
    expect(spacing.lanes).toBeCloseTo(21.54, 2);
    expect(spacing.pictures).toBeCloseTo(9.6, 1);
    expect(altitudeFor(camera, spacing.resolution)).toBeCloseTo(70, 6);
  });

  it('takes pictures on the lanes only, and turns outside', () => {
    const lanes = surveyLanes(field, { spacing: 50, angle: 0 });
    const items = laneItems(lanes, { altitude: 50, pictures: 10, turnaround: 15 });
    expect(items).toHaveLength(lanes.length * 6);
    const commands = items.slice(0, 6).map((each) => each.command);
    const [fly, camera] = [MavCmd.NAV_WAYPOINT, MavCmd.DO_SET_CAM_TRIGG_DIST];
    expect(commands).toEqual([fly, fly, camera, fly, camera, fly]);
    expect(items[2]!.params[0]).toBe(10);
    expect(items[4]!.params[0]).toBe(0);
    const before = { latitude: items[0]!.params[4]!, longitude: items[0]!.params[5]! };
    expect(distance(before, lanes[0]![0]!)).toBeCloseTo(15, 1);
    expect(pictureCount(lanes, 10)).toBe(lanes.length * 11 - lanes.filter((lane) => pathLength(lane) < 100).length);
  });
});
