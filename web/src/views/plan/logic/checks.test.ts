import { describe, expect, it } from 'vitest';

import { check, type CheckInput } from './checks';
import { newItem } from './commands';
import { hgtHeight, hgtSource, heightOfColour, readHgt, tilePlace, tileSource } from './elevation';
import { destination } from './geo';
import { CMD, EMPTY_PLAN, FRAME, item, waypoint, withParam, type Plan } from './model';
import { batteryUse, executionOrder, statisticsOf } from './statistics';
import { profileOf } from './terrain';

const HOME = { latitude: 47.397, longitude: 8.545, altitude: 488 };
const away = (heading: number, metres: number) => destination(HOME, heading, metres);
const good: Plan = {
  ...EMPTY_PLAN,
  home: HOME,
  mission: [
    newItem(CMD.NAV_TAKEOFF, { ...HOME, altitude: 20 }),
    waypoint(away(0, 300), 50),
    waypoint(away(90, 300), 50),
    newItem(CMD.NAV_RETURN_TO_LAUNCH, HOME),
  ],
};
const flat = async (points: readonly unknown[]) => points.map(() => 488);

async function keys(plan: Plan, changed: Partial<CheckInput> = {}): Promise<string[]> {
  const input = { clearance: 15, endurance: 20, ceiling: 120, vehicle: HOME, wing: false, ...changed };
  const profile = changed.profile === undefined ? await profileOf(plan, flat) : changed.profile;
  return check({ ...input, plan, statistics: statisticsOf(plan), profile }).map((each) => each.key);
}

const edited = (index: number, param: number, value: number | null): Plan => ({
  ...good,
  mission: good.mission.map((each, at) => (at === index ? withParam(each, param, value) : each)),
});

describe('statistics', () => {
  it('measure distance and time with climbs', () => {
    const found = statisticsOf(good, { horizontal: 5, up: 2, down: 1 });
    expect(found.distance).toBeCloseTo(300 + 300 * Math.SQRT2 + 300, 0);
    expect(found.duration).toBeCloseTo(20 / 2 + 60 + 60 * Math.SQRT2 + 60, 0);
    expect(found.maxAltitude).toBe(50);
    expect(found.farthest).toBeCloseTo(300, 3);
    expect(batteryUse(found, 10)).toBeCloseTo(found.duration! / 600, 6);
    expect(batteryUse(found, null)).toBeNull();
  });

  it('follow changes of speed, waits, circles and jumps', () => {
    const fast = { ...good, mission: [item(CMD.DO_CHANGE_SPEED, [1, 10, -1], FRAME.MISSION), ...good.mission] };
    expect(statisticsOf(fast).duration!).toBeLessThan(statisticsOf(good).duration!);
    const circles = { ...good, mission: [item(CMD.NAV_LOITER_TURNS, [2, 0, 50, 0, HOME.latitude, HOME.longitude, 30])] };
    expect(statisticsOf(circles).distance).toBeCloseTo(2 * 2 * Math.PI * 50, 3);
    const jump = [good.mission[1]!, good.mission[2]!, item(CMD.DO_JUMP, [0, 2])];
    expect(executionOrder(jump).order).toEqual([0, 1, 0, 1, 0, 1]);
    expect(executionOrder([jump[0]!, item(CMD.DO_JUMP, [0, -1])]).ends).toBe(false);
  });
});

describe('checks', () => {
  it('find nothing wrong with a good plan', async () => {
    expect(await keys(good)).toEqual([]);
  });

  it('tell items that cannot be flown', async () => {
    expect(await keys(edited(1, 5, null))).toContain('checkNoPosition');
    expect(await keys(edited(1, 7, null))).toContain('checkNoAltitude');
    expect(await keys(edited(1, 7, 0))).toContain('checkOnGround');
    expect(await keys(edited(1, 7, 150))).toEqual(['checkCeiling']);
    expect(await keys({ ...good, mission: good.mission.slice(1) })).toContain('checkNoTakeoff');
    expect(await keys({ ...good, mission: good.mission.slice(0, -1) })).toEqual(['checkNoEnd']);
    const jumps = (target: number) => ({ ...good, mission: [...good.mission, item(CMD.DO_JUMP, [target, 1])] });
    expect(await keys(jumps(9))).toContain('checkJumpNowhere');
    expect(await keys(jumps(4))).toContain('checkJumpToItself');
  });

  it('tell what does not fit to the vehicle', async () => {
    expect(await keys(good, { endurance: 4 })).toEqual(['checkBattery']);
    expect(await keys(good, { vehicle: away(0, 9000) })).toEqual(['checkFarFromVehicle']);
  });

  it('tell paths that leave the fence', async () => {
    const circle = (radius: number, inclusion = true) => ({ inclusion, center: HOME, radius });
    expect(await keys({ ...good, circles: [circle(400)] })).toEqual([]);
    expect(await keys({ ...good, circles: [circle(200)] })).toEqual(['checkOutsideFence']);
    expect(await keys({ ...good, circles: [circle(0)] })).toContain('checkNoRadius');
    const tree = { inclusion: false, center: away(45, 212), radius: 20 };
    expect(await keys({ ...good, circles: [tree] })).toEqual(['checkLegLeavesFence']);
    const far = { ...good, circles: [circle(400)], rally: [{ ...away(0, 900), altitude: 30 }] };
    expect(await keys(far)).toEqual(['checkRallyOutside']);
    const corners = [45, 225, 135, 315].map((heading) => away(heading, 900));
    expect(await keys({ ...good, polygons: [{ inclusion: true, vertices: corners }] })).toContain('checkCrossesItself');
  });

  it('tell the clearance above the terrain, or that it is not known', async () => {
    const hill = (height: number) => async (points: readonly unknown[]) => points.map((_, index) => (index > 12 ? 488 + height : 488));
    expect(await keys(good, { profile: await profileOf(good, hill(40)) })).toEqual(['checkNearTerrain']);
    expect(await keys(good, { profile: await profileOf(good, hill(60)) })).toEqual(['checkBelowTerrain']);
    expect(await keys(good, { profile: null })).toEqual(['checkTerrainUnknown']);
  });
});

describe('elevation', () => {
  it('is read from .hgt files', async () => {
    const content = new ArrayBuffer(1201 * 1201 * 2);
    const view = new DataView(content);
    view.setInt16(0, 700);
    view.setInt16(2, 800);
    view.setInt16(1201 * 2, 700);
    view.setInt16(1201 * 2 + 2, 800);
    const file = readHgt('N47E008.hgt', content);
    expect(hgtHeight(file, { latitude: 48, longitude: 8 + 0.5 / 1200 })).toBeCloseTo(750, 6);
    expect(hgtHeight(file, { latitude: 49, longitude: 8 })).toBeNull();
    expect(await hgtSource([file])([{ latitude: 48, longitude: 8 }, { latitude: 0, longitude: 0 }])).toEqual([700, null]);
    expect(() => readHgt('alps.hgt', content)).toThrow('corner');
    expect(() => readHgt('N47E008.hgt', new ArrayBuffer(7))).toThrow('7 bytes');
  });

  it('is read from the colours of tiles', async () => {
    expect(heightOfColour('terrarium', 130, 0, 128)).toBe(512.5);
    expect(heightOfColour('mapbox', 1, 134, 160)).toBe(0);
    expect(tilePlace({ latitude: 0, longitude: 0 }, 1, 256)).toEqual({ x: 1, y: 1, column: 0, row: 0 });
    const loaded: string[] = [];
    const source = tileSource('t/{z}/{x}/{y}', 'terrarium', async (url) => {
      loaded.push(url);
      if (url.endsWith('/0')) throw new Error('gone');
      return { width: 1, data: [130, 0, 0, 255] };
    });
    expect(await source([HOME, HOME, { latitude: 85.05, longitude: 0 }])).toEqual([512, 512, null]);
    expect(loaded).toHaveLength(2);
  });
});
