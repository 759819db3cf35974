import { describe, expect, it } from 'vitest';

import { fenceShapes, missionPath, rallyPlaces } from './plan';
import { symbolKind } from './symbols';
import { aircraftFrom, relativeAltitude } from './traffic';

const HOME = { latitude: 46, longitude: 7 };

const item = (seq: number, command: number, latitude = 0, longitude = 0, first: (number | null)[] = []) => ({
  seq,
  command,
  params: [...[0, 0, 0, null].map((value, index) => first[index] ?? value), latitude, longitude, 30],
});

describe('missionPath', () => {
  it('begins at home with a takeoff, and comes back with RTL', () => {
    const { line, stops } = missionPath([item(0, 22), item(1, 16, 46.1, 7.1), item(2, 20)], HOME);
    expect(line).toEqual([HOME, HOME, { latitude: 46.1, longitude: 7.1 }, HOME]);
    expect(stops.map((stop) => stop.kind)).toEqual(['takeoff', 'waypoint', 'rtl']);
    // Numbered as people count.
    expect(stops.map((stop) => stop.seq)).toEqual([1, 2, 3]);
  });

  it('does not fly to a region of interest, and has no place for commands', () => {
    const { line, stops } = missionPath([item(0, 16, 46.1, 7.1), item(1, 201, 46.2, 7.2), item(2, 178)], null);
    expect(line).toHaveLength(1);
    expect(stops.map((stop) => stop.kind)).toEqual(['waypoint', 'interest']);
  });

  it('shows jumps and the radius of loiter circles', () => {
    const items = [item(0, 16, 46.1, 7.1), item(1, 18, 46.2, 7.2, [3, 0, -40]), item(2, 177, 0, 0, [0, 2])];
    const { jumps, stops } = missionPath(items, null);
    expect(stops[1]!.radius).toBe(-40);
    expect(jumps).toEqual([
      [
        { latitude: 46.2, longitude: 7.2 },
        { latitude: 46.1, longitude: 7.1 },
      ].map((p) => expect.objectContaining(p)),
    ]);
  });

  it('is empty without items, and leaves out places that are not known', () => {
    expect(missionPath([], HOME)).toEqual({ stops: [], line: [], jumps: [] });
    expect(missionPath([item(0, 20)], null).stops).toEqual([]);
  });
});

describe('fenceShapes', () => {
  it('reads polygons and circles', () => {
    const corners = [1, 2, 3].map((number) => item(number, 5001, 46 + number, 7, [3]));
    const shapes = fenceShapes([...corners, item(4, 5004, 46, 7, [60]), item(5, 5000, 46, 7)]);
    expect(shapes.map((shape) => shape.kind)).toEqual(['polygon', 'circle', 'return']);
    expect(shapes[0]).toMatchObject({ isInclusion: true, corners: { length: 3 } });
    expect(shapes[1]).toMatchObject({ isInclusion: false, radius: 60 });
  });

  it('survives a polygon that claims more corners than there are, or none', () => {
    expect(fenceShapes([item(0, 5002, 46, 7, [500])])).toMatchObject([{ corners: { length: 1 } }]);
    expect(fenceShapes([item(0, 5001, 46, 7, [0]), item(1, 5001, 46, 7, [-3])])).toHaveLength(2);
  });

  it('reads rally points', () => {
    expect(rallyPlaces([item(0, 5100, 46.5, 7.5)])).toEqual([{ latitude: 46.5, longitude: 7.5 }]);
  });
});

describe('traffic', () => {
  const fields = {
    ICAO_address: 0x4b1234,
    lat: 460000000,
    lon: 70000000,
    altitude: 1200000,
    heading: 9000,
    hor_velocity: 6000,
    ver_velocity: -120,
    callsign: 'SWR23K ',
    flags: 1 | 2 | 4 | 8 | 16 | 128,
  };

  it('reads ADSB_VEHICLE', () => {
    expect(aircraftFrom(fields, 5)).toEqual({
      address: 0x4b1234,
      callsign: 'SWR23K',
      latitude: 46,
      longitude: 7,
      altitude: 1200,
      heading: 90,
      speed: 60,
      climbRate: -1.2,
      time: 5,
    });
  });

  it('takes no value that its flags do not call valid', () => {
    expect(aircraftFrom({ ...fields, flags: 0 }, 5)).toBeNull();
    expect(aircraftFrom({ ...fields, flags: 1 }, 5)).toMatchObject({ callsign: '4B1234', altitude: null, speed: null });
  });

  it('tells the altitude above the own vehicle', () => {
    const aircraft = aircraftFrom(fields, 5)!;
    expect(relativeAltitude(aircraft, 900)).toBe('+300 m ↓');
    expect(relativeAltitude({ ...aircraft, climbRate: null }, null)).toBe('1200 m');
    expect(relativeAltitude({ ...aircraft, altitude: null }, 900)).toBe('– m');
  });
});

it('has a symbol for every type', () => {
  expect(['copter', 'blimp', 'rocket', 'something'].map(symbolKind)).toEqual([
    'copter',
    'balloon',
    'unknown',
    'unknown',
  ]);
});
