import { MavCmd, MavFrame } from '$generated';

import { describe, expect, it } from 'vitest';

import { check, selectionOf, type CheckInput, type Problem } from './checks';
import { newItem } from './commands';
import { hgtHeight, hgtSource, heightOfColour, readHgt, tilePlace, tileSource } from './elevation';
import { destination } from './geo';
import { EMPTY_PLAN, item, waypoint, withParam, type Plan } from './model';
import { executionOrder, pathOf } from './path';
import { batteryUse, statisticsOf } from './statistics';
import { profileOf } from './terrain';

const HOME = { latitude: 47.397, longitude: 8.545, altitude: 488 };
const away = (heading: number, metres: number) => destination(HOME, heading, metres);
const good: Plan = {
  ...EMPTY_PLAN,
  home: HOME,
  mission: [
    newItem(MavCmd.NAV_TAKEOFF, { ...HOME, altitude: 20 }),
    waypoint(away(0, 300), 50),
    waypoint(away(90, 300), 50),
    newItem(MavCmd.NAV_RETURN_TO_LAUNCH, HOME),
  ],
};
const away2 = (north: number, east: number) => destination(away(0, north), 90, east);
const flat = async (points: readonly unknown[]) => points.map(() => 488);

async function keys(plan: Plan, changed: Partial<CheckInput> = {}): Promise<string[]> {
  const input = { clearance: 15, endurance: 20, ceiling: 120, vehicle: HOME, wing: false, firmware: 3, ...changed };
  const profile = changed.profile === undefined ? await profileOf(plan, flat) : changed.profile;
  return check({ ...input, plan, statistics: statisticsOf(plan), profile }).map((each) => each.key);
}

const [ARDUPILOT, PX4] = [3, 12];

async function graded(plan: Plan, firmware: number, endurance: number | null = 20): Promise<string[]> {
  const input = { clearance: 15, endurance, ceiling: 120, vehicle: HOME, wing: false, firmware };
  const found = check({ ...input, plan, statistics: statisticsOf(plan), profile: await profileOf(plan, flat) });
  return found.map(({ severity, key }) => `${severity} ${key}`);
}

const edited = (index: number, param: number, value: number | null): Plan => ({
  ...good,
  mission: good.mission.map((each, at) => (at === index ? withParam(each, param, value) : each)),
});

describe('statistics', () => {
  it('measure distance and time with climbs', () => {
    const found = statisticsOf(good, { horizontal: 5, up: 2, down: 1 });
    expect(found.distance).toBeCloseTo(300 + 300 * Math.SQRT2 + 300, 0);
    expect(found.duration).toBeCloseTo(20 / 2 + 60 + 60 * Math.SQRT2 + 60 + 50, 0);
    expect(found.maxAltitude).toBe(50);
    expect(found.farthest).toBeCloseTo(300, 3);
    expect(batteryUse(found, 10)).toBeCloseTo(found.duration! / 600, 6);
    expect(batteryUse(found, null)).toBeNull();
  });

  it('follow changes of speed, waits, circles and jumps', () => {
    const fast = { ...good, mission: [item(MavCmd.DO_CHANGE_SPEED, [1, 10, -1], MavFrame.MISSION), ...good.mission] };
    expect(statisticsOf(fast).duration!).toBeLessThan(statisticsOf(good).duration!);
    const circles = {
      ...good,
      mission: [item(MavCmd.NAV_LOITER_TURNS, [2, 0, 50, 0, HOME.latitude, HOME.longitude, 30])],
    };
    expect(statisticsOf(circles).distance).toBeCloseTo(2 * 2 * Math.PI * 50, 3);
    const jump = [good.mission[1]!, good.mission[2]!, item(MavCmd.DO_JUMP, [0, 2])];
    expect(executionOrder(jump).order).toEqual([0, 1, 0, 1, 0, 1]);
    expect(executionOrder([jump[0]!, item(MavCmd.DO_JUMP, [0, -1])]).ends).toBe(false);
  });
});

describe('the time of a flight', () => {
  const speeds = { horizontal: 5, up: 2, down: 1 };
  const durationOf = (mission: Plan['mission'], plan: Partial<Plan> = {}): number =>
    statisticsOf({ ...good, mission, ...plan }, speeds).duration!;
  const speed = (type: number, metres: number) => item(MavCmd.DO_CHANGE_SPEED, [type, metres, -1], MavFrame.MISSION);
  const east = waypoint(away(90, 300), 30);
  const up = newItem(MavCmd.NAV_TAKEOFF, { ...HOME, altitude: 30 });

  it('follows the kind of a changed speed', () => {
    expect(durationOf([up, east])).toBeCloseTo(15 + 60, 1);
    expect(durationOf([up, speed(1, 10), east])).toBeCloseTo(15 + 30, 1);
    expect(durationOf([up, speed(1, 10), speed(1, -2), east])).toBeCloseTo(15 + 60, 1);
    expect(durationOf([up, speed(1, -1), east])).toBeCloseTo(15 + 60, 1);
    expect(durationOf([speed(2, 10), up, east])).toBeCloseTo(3 + 60, 1);
    expect(durationOf([speed(3, 10), up, east, newItem(MavCmd.NAV_RETURN_TO_LAUNCH, HOME)])).toBeCloseTo(
      15 + 120 + 3,
      1,
    );
  });

  it('knows that a VTOL hovers and flies', () => {
    const transition = (state: number) => item(MavCmd.DO_VTOL_TRANSITION, [state], MavFrame.MISSION);
    const vtol = { vehicleType: 22, cruiseSpeed: 20, hoverSpeed: 3 };
    expect(durationOf([up, transition(4), east], vtol)).toBeCloseTo(15 + 15, 1);
    expect(durationOf([up, transition(3), east], vtol)).toBeCloseTo(15 + 100, 1);
  });

  it('has a descent where a copter lands, and none on the way of a wing', () => {
    const land = newItem(MavCmd.NAV_LAND, { ...away(90, 300), altitude: 0 });
    expect(durationOf([up, land])).toBeCloseTo(15 + 60 + 30, 1);
    expect(durationOf([up, land], { vehicleType: 1 })).toBeCloseTo(15 + 60, 1);
    const back = [up, east, newItem(MavCmd.NAV_RETURN_TO_LAUNCH, HOME)];
    expect(pathOf({ ...good, mission: back }).at(-1)!.altitude).toBe(0);
    expect(pathOf({ ...good, mission: back, vehicleType: 1 }).at(-1)!.altitude).toBe(30);
  });

  it('ends for jumps that name one another for ever', () => {
    const jumps = [item(MavCmd.DO_JUMP, [1, 1e12]), item(MavCmd.DO_JUMP, [0, 1e12]), east];
    expect(executionOrder(jumps).ends).toBe(false);
  });

  it('counts a picture at the begin of a lane and after each interval, also around bends', () => {
    const trigger = (metres: number) => item(MavCmd.DO_SET_CAM_TRIGG_DIST, [metres], MavFrame.MISSION);
    const lane = [
      waypoint(HOME, 30),
      trigger(100),
      waypoint(away(90, 150), 30),
      waypoint(away(90, 310), 30),
      trigger(0),
      east,
    ];
    expect(statisticsOf({ ...good, mission: lane }).pictures).toBe(4);
  });
});

describe('the clearance of legs', () => {
  const clearances = async (plan: Plan, ground: number[] = []) =>
    (await profileOf(plan, async (points) => points.map((_, index) => ground[index] ?? 488))).lowest?.clearance;
  const to = (altitude: number, frame: number = MavFrame.GLOBAL_RELATIVE_ALT) =>
    waypoint(away(90, 300), altitude, frame);
  const begin = waypoint(HOME, 40);

  it('counts from the right reference in every frame', async () => {
    const plan = (...mission: Plan['mission']): Plan => ({ ...good, mission });
    expect(await clearances(plan(begin, to(60)))).toBeCloseTo(42, 0);
    expect(await clearances(plan(begin, to(488 + 60, MavFrame.GLOBAL)))).toBeCloseTo(42, 0);
    expect(await clearances(plan(begin, to(488 + 10, MavFrame.GLOBAL)))).toBeCloseTo(10, 0);
    const hills = Array.from({ length: 13 }, (_, index) => 488 + 10 * index);
    const follow = plan(waypoint(HOME, 40, MavFrame.GLOBAL_TERRAIN_ALT), to(40, MavFrame.GLOBAL_TERRAIN_ALT));
    expect(await clearances(follow, hills)).toBeCloseTo(40, 6);
  });

  it('is not asked of a landing, and of all of the way to it', async () => {
    const land = newItem(MavCmd.NAV_LAND, { ...away(90, 300), altitude: 0 });
    expect(await clearances({ ...good, mission: [begin, land] })).toBeCloseTo(40, 6);
    expect(pathOf({ ...good, mission: [begin, land] }).map((each) => each.altitude)).toEqual([0, 40, 40, 0]);
    expect(await keys({ ...good, mission: [good.mission[0]!, good.mission[1]!, land] })).toEqual([]);
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
    const jumps = (target: number) => ({ ...good, mission: [...good.mission, item(MavCmd.DO_JUMP, [target, 1])] });
    expect(await keys(jumps(9))).toContain('checkJumpNowhere');
    expect(await keys(jumps(4))).toContain('checkJumpToItself');
  });

  it('tell what does not fit to the vehicle', async () => {
    expect(await keys(good, { vehicle: away(0, 9000) })).toEqual(['checkFarFromVehicle']);
    const far = { ...good, mission: [good.mission[0]!, waypoint(away(0, 21_000), 50), good.mission[3]!] };
    expect(await keys(far, { endurance: null, vehicle: null })).toEqual(['checkFarFromHome']);
  });

  it('tell a mission that needs most of the battery, or more than it has', async () => {
    const minutes = statisticsOf(good).duration! / 60;
    expect(await graded(good, ARDUPILOT, minutes / 0.75)).toEqual([]);
    expect(await graded(good, ARDUPILOT, minutes / 0.85)).toEqual(['warning checkBattery']);
    expect(await graded(good, ARDUPILOT, minutes / 1.05)).toEqual(['error checkBattery']);
  });

  it('tell params outside of their range, and a mission that does not end', async () => {
    const [CONDITION_YAW, first] = [115, good.mission[0]!];
    const after = (command: number, param: number) => ({
      ...good,
      mission: [first, item(command, [param], MavFrame.MISSION), ...good.mission.slice(1)],
    });
    expect(await graded(after(CONDITION_YAW, 360), ARDUPILOT)).toEqual([]);
    expect(await graded(after(CONDITION_YAW, 361), ARDUPILOT)).toEqual(['warning checkParamHigh']);
    expect(await graded(after(MavCmd.DO_SET_CAM_TRIGG_DIST, -1), ARDUPILOT)).toEqual(['warning checkParamLow']);
    const stay = {
      ...good,
      mission: [...good.mission.slice(0, -1), newItem(MavCmd.NAV_LOITER_UNLIM, { ...HOME, altitude: 30 })],
    };
    expect(await graded(stay, ARDUPILOT)).toEqual(['info checkEndless']);
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

  it('know what each firmware makes of several areas to stay in', async () => {
    const areas = [away(0, 150), away(90, 150)].map((center) => ({ inclusion: true, center, radius: 260 }));
    // Two circles, one around each waypoint; home is in both, each waypoint in one.
    expect(await graded({ ...good, circles: areas }, PX4)).toEqual(['error checkPartly']);
    expect(await graded({ ...good, circles: areas }, ARDUPILOT)).toEqual(['warning checkPartly']);
    const apart = [HOME, away(0, 300), away(90, 300)].map((center) => ({ inclusion: true, center, radius: 50 }));
    expect(await graded({ ...good, circles: apart }, ARDUPILOT)).toEqual(['warning checkLegLeavesFence']);
    const wide = { inclusion: true, center: HOME, radius: 500 };
    const rally = [{ ...away(0, 450), altitude: 30 }];
    const inner = { ...wide, radius: 400 };
    expect(await graded({ ...good, circles: [wide, inner], rally }, PX4)).toEqual(['error checkRallyPartly']);
    const besideHome = { inclusion: true, center: away(0, 300), radius: 290 };
    expect(
      await graded({ ...good, mission: good.mission.slice(0, 1), circles: [wide, besideHome] }, ARDUPILOT),
    ).toContain('warning checkHomePartly');
  });

  it('tell areas that PX4 ignores, and nothing of a fence without areas to stay in', async () => {
    const [tree, house] = [away(180, 300), HOME].map((center) => ({ inclusion: false, center, radius: 20 }));
    for (const firmware of [PX4, ARDUPILOT]) expect(await graded({ ...good, circles: [tree!] }, firmware)).toEqual([]);
    expect(await graded({ ...good, circles: [tree!, house!] }, PX4)).toContain('error checkCircleIgnored');
    expect(await graded({ ...good, circles: [house!] }, ARDUPILOT)).toEqual(['error checkHomeOutside']);
    const box = [away2(100, 100), away2(200, 100), away2(200, 200), away2(100, 200)];
    expect(await graded({ ...good, polygons: [{ inclusion: true, vertices: box }] }, PX4)).toContain(
      'error checkPolygonIgnored',
    );
  });

  it('are about a part of the plan, or all of it', () => {
    const part = (kind: Problem['kind'], key: Problem['key'], index: number | null) =>
      selectionOf({ severity: 'error', kind, key, index, values: {} });
    expect(part('mission', 'checkNoAltitude', 2)).toEqual({ kind: 'item', index: 2 });
    expect(part('fence', 'checkCrossesItself', 1)).toEqual({ kind: 'polygon', index: 1 });
    expect(part('fence', 'checkPolygonIgnored', 1)).toEqual({ kind: 'polygon', index: 1 });
    expect(part('fence', 'checkNoRadius', 1)).toEqual({ kind: 'circle', index: 1 });
    expect(part('fence', 'checkCircleIgnored', 0)).toEqual({ kind: 'circle', index: 0 });
    expect(part('rally', 'checkRallyOutside', 0)).toEqual({ kind: 'rally', index: 0 });
    expect(part('mission', 'checkBattery', null)).toBeNull();
  });

  it('tell a leg that leaves through a corner, and a return point that is outside', async () => {
    const box = [
      [-100, -400],
      [400, -400],
      [400, 400],
      [-100, 400],
    ].map(([north, east]) => away2(north!, east!));
    expect(await keys({ ...good, polygons: [{ inclusion: true, vertices: box }] })).toEqual([]);
    // A tree whose corner lies on the straight way from the first to the second waypoint.
    const tree = [away2(150, 150), away2(190, 190), away2(150, 190)];
    expect(await keys({ ...good, polygons: [{ inclusion: false, vertices: tree }] })).toEqual([]);
    const edge = [away2(100, 100), away2(200, 200), away2(200, 100)];
    expect(await keys({ ...good, polygons: [{ inclusion: false, vertices: edge }] })).toEqual(['checkLegLeavesFence']);
    const outside = {
      ...good,
      polygons: [{ inclusion: true, vertices: box }],
      returnPoint: { ...away(180, 300), altitude: 30 },
    };
    expect(await keys(outside)).toEqual(['checkReturnOutside']);
  });

  it('tell the clearance above the terrain, or that it is not known', async () => {
    const hill = (height: number) => async (points: readonly unknown[]) =>
      points.map((_, index) => (index > 12 ? 488 + height : 488));
    expect(await keys(good, { profile: await profileOf(good, hill(40)) })).toEqual(['checkNearTerrain']);
    expect(await keys(good, { profile: await profileOf(good, hill(60)) })).toEqual(['checkBelowTerrain']);
    expect(await keys(good, { profile: null })).toEqual(['checkTerrainUnknown']);
    const partly = async (points: readonly unknown[]) => points.map((_, index) => (index > 12 ? null : 488));
    expect(await keys(good, { profile: await profileOf(good, partly) })).toEqual(['checkTerrainPartly']);
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
    expect(
      await hgtSource([file])([
        { latitude: 48, longitude: 8 },
        { latitude: 0, longitude: 0 },
      ]),
    ).toEqual([700, null]);
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
    // A transparent pixel is no height.
    expect(await tileSource('{z}', 'terrarium', async () => ({ width: 1, data: [0, 0, 0, 0] }))([HOME])).toEqual([
      null,
    ]);
  });
});
