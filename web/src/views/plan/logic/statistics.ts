/** The length, duration and energy of a mission, from the path that the vehicle flies. */

import { CMD, FRAME, type Item, type Plan } from './model';
import { bearing, distance, type Point } from './geo';
import { isOnPath, itemPosition } from './commands';

/** A point of the path; `item` is the index of the mission item, -1 at home. */
export interface PathPoint extends Point {
  readonly item: number;
  /** Metres in the frame. */
  readonly altitude: number;
  readonly frame: number;
}

export interface Leg {
  readonly from: PathPoint;
  readonly to: PathPoint;
  /** Metres over ground. */
  readonly length: number;
  /** Degrees. */
  readonly bearing: number;
  /** Metres, positive upwards; null where both ends have different references. */
  readonly climb: number | null;
  /** Metres per second. */
  readonly speed: number;
  /** Seconds, with the loitering and waiting at its end. */
  readonly duration: number;
}

export interface FlightSpeeds {
  /** Metres per second. */
  readonly horizontal: number;
  readonly up: number;
  readonly down: number;
}

export interface Statistics {
  readonly legs: readonly Leg[];
  /** Metres over ground, with the circles of loitering. */
  readonly distance: number;
  /** Seconds; null: the mission does not end by itself. */
  readonly duration: number | null;
  /** Metres above home; null without relative altitudes. */
  readonly maxAltitude: number | null;
  /** Metres from home to the farthest point; null without a home. */
  readonly farthest: number | null;
  readonly longestLeg: number;
  readonly itemCount: number;
  readonly pictures: number;
}

const WINGS: ReadonlySet<number> = new Set([1, 7, 16, 19, 20, 21, 22, 23, 24, 25, 28]);
/** Items that a jump may make the vehicle fly before the mission counts as endless. */
const MAX_VISITS = 10_000;

/** Returns the speeds of a plan's vehicle. */
export function speedsOf(plan: Plan): FlightSpeeds {
  const wing = isWing(plan);
  return { horizontal: Math.max(0.1, wing ? plan.cruiseSpeed : plan.hoverSpeed), up: 2.5, down: 1.5 };
}

/** Returns the indexes of items in the order of execution, with jumps; null if there is no end. */
export function executionOrder(mission: readonly Item[]): { order: number[]; ends: boolean } {
  const left = new Map<number, number>();
  const order: number[] = [];
  let at = 0;
  while (at < mission.length && order.length < MAX_VISITS) {
    const each = mission[at]!;
    if (each.command !== CMD.DO_JUMP) {
      order.push(at);
      if (each.command === CMD.NAV_LOITER_UNLIM) return { order, ends: false };
      if (each.command === CMD.NAV_RETURN_TO_LAUNCH) return { order, ends: true };
      at += 1;
      continue;
    }
    const [target, repeat] = [each.params[0] ?? -1, each.params[1] ?? 0];
    if (repeat < 0) return { order, ends: false };
    const remaining = left.get(at) ?? repeat;
    left.set(at, remaining > 0 ? remaining - 1 : repeat);
    const jumps = remaining > 0 && Number.isInteger(target) && target >= 0 && target < mission.length && target !== at;
    at = jumps ? target : at + 1;
  }
  return { order, ends: order.length < MAX_VISITS };
}

function homePoint(plan: Plan): PathPoint | null {
  const home = plan.home;
  return home && { ...home, altitude: 0, item: -1, frame: FRAME.GLOBAL_RELATIVE_ALT };
}

/** Returns the points that the vehicle flies to, from home, in the order of execution. */
export function pathOf(plan: Plan): PathPoint[] {
  const home = homePoint(plan);
  const points: PathPoint[] = home ? [home] : [];
  for (const index of executionOrder(plan.mission).order) {
    const point = pointOf(plan, index, points.at(-1) ?? null);
    if (point) points.push(point);
  }
  return points;
}

/** Returns the point of an item; a takeoff or landing without a position happens where the vehicle is. */
function pointOf(plan: Plan, index: number, last: PathPoint | null): PathPoint | null {
  const each = plan.mission[index]!;
  if (each.command === CMD.NAV_RETURN_TO_LAUNCH) {
    const home = homePoint(plan);
    const keeps = last?.frame === FRAME.GLOBAL_RELATIVE_ALT ? last.altitude : 0;
    return home && { ...home, altitude: keeps, item: index };
  }
  const altitude = each.params[6] ?? 0;
  if (isOnPath(each)) return { ...itemPosition(each)!, item: index, altitude, frame: each.frame };
  const vertical: number[] = [CMD.NAV_TAKEOFF, CMD.NAV_VTOL_TAKEOFF, CMD.NAV_LAND, CMD.NAV_VTOL_LAND];
  return vertical.includes(each.command) && last ? { ...last, item: index, altitude, frame: each.frame } : null;
}

/** Seconds and metres that an item adds at its position. */
function stay(each: Item, speed: number): { seconds: number; metres: number } {
  const [first, , third] = each.params;
  if (each.command === CMD.NAV_LOITER_TURNS) {
    const metres = 2 * Math.PI * Math.abs(third || 0) * Math.abs(first ?? 0);
    return { seconds: metres / speed, metres };
  }
  const waits: number[] = [CMD.NAV_WAYPOINT, CMD.NAV_LOITER_TIME, CMD.NAV_DELAY, CMD.NAV_SPLINE_WAYPOINT, CMD.CONDITION_DELAY];
  return { seconds: waits.includes(each.command) ? Math.max(0, first ?? 0) : 0, metres: 0 };
}

function legOf(from: PathPoint, to: PathPoint, speed: number, speeds: FlightSpeeds): Leg {
  const length = distance(from, to);
  const climb = from.frame === to.frame ? to.altitude - from.altitude : null;
  const vertical = climb === null ? 0 : climb > 0 ? climb / speeds.up : -climb / speeds.down;
  const duration = Math.max(length / speed, vertical);
  return { from, to, length, bearing: bearing(from, to), climb, speed, duration };
}

/** Returns the statistics of a plan's mission. */
export function statisticsOf(plan: Plan, speeds: FlightSpeeds = speedsOf(plan)): Statistics {
  const { order, ends } = executionOrder(plan.mission);
  const legs: Leg[] = [];
  let last = homePoint(plan);
  let [speed, extraMetres, extraSeconds, interval, pictures] = [speeds.horizontal, 0, 0, 0, 0];
  for (const index of order) {
    const each = plan.mission[index]!;
    if (each.command === CMD.DO_CHANGE_SPEED && (each.params[1] ?? -1) > 0) speed = each.params[1]!;
    if (each.command === CMD.DO_SET_CAM_TRIGG_DIST) interval = Math.max(0, each.params[0] ?? 0);
    const to = pointOf(plan, index, last);
    if (to && last) {
      const leg = legOf(last, to, speed, speeds);
      if (interval > 0) pictures += Math.floor(leg.length / interval) + 1;
      legs.push(leg);
    }
    const { seconds, metres } = stay(each, speed);
    [extraSeconds, extraMetres, last] = [extraSeconds + seconds, extraMetres + metres, to ?? last];
  }
  const sum = (values: readonly number[]): number => values.reduce((total, value) => total + value, 0);
  return {
    legs,
    distance: sum(legs.map((leg) => leg.length)) + extraMetres,
    duration: ends ? sum(legs.map((leg) => leg.duration)) + extraSeconds : null,
    ...extremes(plan, legs),
    itemCount: plan.mission.length,
    pictures,
  };
}

function extremes(plan: Plan, legs: readonly Leg[]): Pick<Statistics, 'maxAltitude' | 'farthest' | 'longestLeg'> {
  const points = legs.map((leg) => leg.to);
  const relative = points.filter((point) => point.frame === FRAME.GLOBAL_RELATIVE_ALT).map((point) => point.altitude);
  const home = plan.home;
  return {
    maxAltitude: relative.length ? Math.max(...relative) : null,
    farthest: home ? Math.max(0, ...points.map((point) => distance(home, point))) : null,
    longestLeg: Math.max(0, ...legs.map((leg) => leg.length)),
  };
}

/** Returns the part of the battery that the mission needs, from 0; null if that is not known. */
export function batteryUse(statistics: Statistics, enduranceMinutes: number | null): number | null {
  if (!enduranceMinutes || statistics.duration === null) return null;
  return statistics.duration / (enduranceMinutes * 60);
}

/** Returns whether the plan's vehicle flies on a wing. */
export function isWing(plan: Plan): boolean {
  return WINGS.has(plan.vehicleType);
}
