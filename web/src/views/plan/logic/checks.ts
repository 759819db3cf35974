/** Checks of a plan, before a vehicle refuses it or flies it differently. */

import { MavAutopilot, MavCmd, MavFrame } from '$generated';
import type { plan as texts } from '$lib/i18n/en/plan';

import { commandInfo, isOnPath, itemPosition } from './commands';
import type { Selection } from './edits';
import { allows, gradeOf, legLeaves } from './fenceCheck';
import { crossesItself, distance, type Point } from './geo';
import { isEmpty, type Circle, type Item, type Plan, type PlanKind, type Polygon } from './model';
import { pathOf, type PathPoint } from './path';
import { batteryUse, type Statistics } from './statistics';
import type { Profile } from './terrain';

export type CheckKey = Extract<keyof typeof texts, `check${string}`>;
export type Severity = 'error' | 'warning' | 'info';

export interface Problem {
  readonly severity: Severity;
  readonly kind: PlanKind;
  /** The index of the item, area or point; null: the whole plan. */
  readonly index: number | null;
  /** The name of the text in the catalogue of the view. */
  readonly key: CheckKey;
  readonly values: Readonly<Record<string, string | number>>;
}

export interface CheckInput {
  readonly plan: Plan;
  readonly statistics: Statistics;
  readonly profile: Profile | null;
  /** Metres that the path must keep above the ground. */
  readonly clearance: number;
  /** Minutes that a full battery lasts; null: not known. */
  readonly endurance: number | null;
  /** Metres above home that rules of most countries allow; null: no limit. */
  readonly ceiling: number | null;
  /** The vehicle's position; null: not known. */
  readonly vehicle: Point | null;
  readonly wing: boolean;
  /** MAV_AUTOPILOT of the vehicle that will fly. */
  readonly firmware: number;
}

/** Problems of the fence whose index is that of a circle. */
const OF_CIRCLES: ReadonlySet<CheckKey> = new Set(['checkNoRadius', 'checkCircleIgnored']);
/** The part of a battery that a mission may need. */
const USABLE_BATTERY = 0.8;
const FAR_FROM_VEHICLE = 5000;
const FAR_FROM_HOME = 20_000;
const ENDS: ReadonlySet<number> = new Set([
  MavCmd.NAV_RETURN_TO_LAUNCH,
  MavCmd.NAV_LAND,
  MavCmd.NAV_VTOL_LAND,
  MavCmd.NAV_LOITER_UNLIM,
]);
const TAKEOFFS: ReadonlySet<number> = new Set([MavCmd.NAV_TAKEOFF, MavCmd.NAV_VTOL_TAKEOFF]);
const MUST_HAVE_POSITION: ReadonlySet<number> = new Set([MavCmd.NAV_WAYPOINT, MavCmd.NAV_SPLINE_WAYPOINT]);
const RANK: Readonly<Record<Severity, number>> = { error: 0, warning: 1, info: 2 };

type Values = Readonly<Record<string, string | number>>;

function problem(
  severity: Severity,
  kind: PlanKind,
  key: CheckKey,
  index: number | null = null,
  values: Values = {},
): Problem {
  return { severity, kind, index, key, values: index === null ? values : { number: index + 1, ...values } };
}

/** Returns the part of the plan that a problem is about; null: the whole plan. */
export function selectionOf({ kind, key, index }: Problem): Selection | null {
  if (index === null) return null;
  if (kind === 'fence') return { kind: OF_CIRCLES.has(key) ? 'circle' : 'polygon', index };
  return { kind: kind === 'mission' ? 'item' : 'rally', index };
}

/** Returns the problems of a plan, the worst first. */
export function check(input: CheckInput): Problem[] {
  const { plan } = input;
  const found = [
    ...plan.mission.flatMap((each, index) => itemProblems(plan, each, index)),
    ...missionProblems(input),
    ...areaProblems(plan),
    ...fenceProblems(plan, input.firmware),
    ...terrainProblems(input),
  ];
  return found.sort((a, b) => RANK[a.severity] - RANK[b.severity]);
}

function itemProblems(plan: Plan, each: Item, index: number): Problem[] {
  const error = (key: CheckKey, values: Values = {}): Problem => problem('error', 'mission', key, index, values);
  if (each.kept) return [error('checkKept', { kind: each.kept.kind })];
  const found: Problem[] = [];
  const info = commandInfo(each.command);
  const [latitude, longitude, altitude] = each.params.slice(4);
  if (info.hasLocation && each.frame !== MavFrame.MISSION) {
    if (MUST_HAVE_POSITION.has(each.command) && itemPosition(each) === null) found.push(error('checkNoPosition'));
    if (Math.abs(latitude ?? 0) > 90 || Math.abs(longitude ?? 0) > 180) found.push(error('checkOffEarth'));
    if (altitude == null && MUST_HAVE_POSITION.has(each.command)) found.push(error('checkNoAltitude'));
  }
  if (each.command === MavCmd.DO_JUMP) {
    const target = each.params[0] ?? -1;
    if (!Number.isInteger(target) || target < 0 || target >= plan.mission.length) found.push(error('checkJumpNowhere'));
    else if (target === index) found.push(error('checkJumpToItself'));
  }
  for (const { index: number, minimum, maximum, label } of info.params) {
    const value = each.params[number - 1];
    if (value == null) continue;
    const values = { label, value, minimum: minimum ?? '', maximum: maximum ?? '' };
    if (minimum !== null && value < minimum) found.push(problem('warning', 'mission', 'checkParamLow', index, values));
    if (maximum !== null && value > maximum) found.push(problem('warning', 'mission', 'checkParamHigh', index, values));
  }
  if (MUST_HAVE_POSITION.has(each.command) && altitude != null && altitude <= 0 && each.frame !== MavFrame.GLOBAL) {
    found.push(problem('warning', 'mission', 'checkOnGround', index, { altitude }));
  }
  return found;
}

function missionProblems(input: CheckInput): Problem[] {
  const { plan, statistics, endurance, ceiling, vehicle } = input;
  if (isEmpty(plan, 'mission')) return [];
  const found: Problem[] = [];
  const add = (severity: Severity, key: CheckKey, index: number | null = null, values: Values = {}): void => {
    found.push(problem(severity, 'mission', key, index, values));
  };
  const firstFlown = plan.mission.findIndex((each) => commandInfo(each.command).name.startsWith('NAV_'));
  if (firstFlown >= 0 && !TAKEOFFS.has(plan.mission[firstFlown]!.command)) add('warning', 'checkNoTakeoff');
  if (!plan.mission.some((each) => ENDS.has(each.command))) add(input.wing ? 'warning' : 'info', 'checkNoEnd');
  if (statistics.duration === null) add('info', 'checkEndless');
  const used = batteryUse(statistics, endurance);
  if (used !== null && used > USABLE_BATTERY)
    add(used > 1 ? 'error' : 'warning', 'checkBattery', null, { percent: Math.round(used * 100) });
  const tooHigh = plan.mission.findIndex(
    (each) =>
      ceiling !== null &&
      each.frame === MavFrame.GLOBAL_RELATIVE_ALT &&
      isOnPath(each) &&
      (each.params[6] ?? 0) > ceiling,
  );
  if (tooHigh >= 0)
    add('info', 'checkCeiling', tooHigh, { altitude: plan.mission[tooHigh]!.params[6]!, limit: ceiling! });
  const first = pathOf({ ...plan, home: null })[0];
  if (vehicle && first && distance(vehicle, first) > FAR_FROM_VEHICLE) {
    add('warning', 'checkFarFromVehicle', first.item, { distance: Math.round(distance(vehicle, first) / 1000) });
  }
  if (statistics.farthest !== null && statistics.farthest > FAR_FROM_HOME) {
    add('warning', 'checkFarFromHome', null, { distance: Math.round(statistics.farthest / 1000) });
  }
  return found;
}

function areaProblems(plan: Plan): Problem[] {
  const polygons = plan.polygons.flatMap((polygon, index) => {
    if (polygon.vertices.length < 3) return [problem('error', 'fence', 'checkFewVertices', index)];
    return crossesItself(polygon.vertices) ? [problem('error', 'fence', 'checkCrossesItself', index)] : [];
  });
  const circles = plan.circles.flatMap((circle, index) =>
    circle.radius > 0 ? [] : [problem('error', 'fence', 'checkNoRadius', index)],
  );
  return [...polygons, ...circles];
}

/** Returns the problems of home, path, rally points and return point with the fence. */
function fenceProblems(plan: Plan, firmware: number): Problem[] {
  if (plan.polygons.length + plan.circles.length === 0) return [];
  const found = [...pathProblems(plan, firmware), ...(firmware === MavAutopilot.PX4 ? ignoredAreas(plan) : [])];
  plan.rally.forEach((point, index) => {
    const grade = gradeOf(plan, point);
    if (grade === 'forbidden') found.push(problem('error', 'rally', 'checkRallyOutside', index));
    if (grade === 'partly') found.push(problem(ofPartly(firmware), 'rally', 'checkRallyPartly', index));
  });
  if (plan.returnPoint && gradeOf(plan, plan.returnPoint) === 'forbidden')
    found.push(problem('error', 'fence', 'checkReturnOutside'));
  return found;
}

/** ArduPilot may be set to ask for one of the areas to stay in; PX4 refuses the mission. */
function ofPartly(firmware: number): Severity {
  return firmware === MavAutopilot.PX4 ? 'error' : 'warning';
}

function pathProblems(plan: Plan, firmware: number): Problem[] {
  const path = pathOf(plan);
  const grades = path.map((point) => gradeOf(plan, point));
  const outside = path[grades.indexOf('forbidden')];
  if (outside) {
    const key = outside.item < 0 ? 'checkHomeOutside' : 'checkOutsideFence';
    return [problem('error', 'mission', key, outside.item < 0 ? null : outside.item)];
  }
  const leg = firstLeg(path, (from, to) => legLeaves(plan, from, to, (point) => gradeOf(plan, point) !== 'forbidden'));
  if (leg) return [problem('warning', 'mission', 'checkLegLeavesFence', leg.item)];
  const home = grades[0] === 'partly' && path[0]!.item < 0;
  if (home) return [problem(ofPartly(firmware), 'mission', 'checkHomePartly')];
  const partly =
    firstLeg(path, (from, to) => legLeaves(plan, from, to, (point) => gradeOf(plan, point) === 'allowed')) ??
    path[grades.indexOf('partly')];
  return partly ? [problem(ofPartly(firmware), 'mission', 'checkPartly', partly.item)] : [];
}

/** Returns the end of the first leg that something holds for. */
function firstLeg(
  path: readonly PathPoint[],
  holds: (from: PathPoint, to: PathPoint) => boolean,
): PathPoint | undefined {
  return path.find((to, index) => index > 0 && holds(path[index - 1]!, to));
}

/** Returns the areas that PX4 does not take, since they do not allow home. */
function ignoredAreas({ home, polygons, circles }: Plan): Problem[] {
  if (home === null) return [];
  const ignored = (key: CheckKey, areas: readonly (Polygon | Circle)[]): Problem[] =>
    areas.flatMap((each, index) => (allows(each, home) ? [] : [problem('error', 'fence', key, index)]));
  return [...ignored('checkPolygonIgnored', polygons), ...ignored('checkCircleIgnored', circles)];
}

function terrainProblems({ plan, profile, clearance }: CheckInput): Problem[] {
  if (pathOf(plan).length < 2 || isEmpty(plan, 'mission')) return [];
  if (!profile || profile.known === 0) return [problem('info', 'mission', 'checkTerrainUnknown')];
  const lowest = profile.lowest;
  const values = { clearance: Math.round(lowest?.clearance ?? 0), limit: clearance };
  const index = lowest && lowest.item >= 0 ? lowest.item : null;
  if (lowest && lowest.clearance! < 0) return [problem('error', 'mission', 'checkBelowTerrain', index, values)];
  if (lowest && lowest.clearance! < clearance)
    return [problem('warning', 'mission', 'checkNearTerrain', index, values)];
  return profile.known < 1 ? [problem('info', 'mission', 'checkTerrainPartly')] : [];
}
