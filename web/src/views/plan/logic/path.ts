/** The path of a mission: which items are executed in which order, and the points that the vehicle flies to. */

import { MavCmd, MavFrame, MavType } from '$generated';

import type { Item, Plan } from './model';
import { distance, type Point } from './geo';
import { isOnPath, itemPosition } from './commands';

/** A point of the path; `item` is the index of the mission item, -1 at home. */
export interface PathPoint extends Point {
  readonly item: number;
  /** Metres in the frame. */
  readonly altitude: number;
  readonly frame: number;
  /** The way to the point touches the ground on purpose: a takeoff or a landing. */
  readonly touchesGround?: boolean;
}

/** MAV_TYPE of vehicles that fly on a wing. */
const WINGS: ReadonlySet<number> = new Set([
  MavType.FIXED_WING,
  MavType.AIRSHIP,
  MavType.FLAPPING_WING,
  MavType.VTOL_TAILSITTER_DUOROTOR,
  MavType.VTOL_TAILSITTER_QUADROTOR,
  MavType.VTOL_TILTROTOR,
  MavType.VTOL_FIXEDROTOR,
  MavType.VTOL_TAILSITTER,
  MavType.VTOL_TILTWING,
  MavType.VTOL_RESERVED5,
  MavType.PARAFOIL,
]);
/** Items that jumps may make the vehicle execute before the mission counts as endless. */
const MAX_VISITS = 10_000;
/** Metres within which a vehicle is at a place already. */
const SAME_PLACE = 1;
const TAKEOFFS: ReadonlySet<number> = new Set([MavCmd.NAV_TAKEOFF, MavCmd.NAV_VTOL_TAKEOFF]);
const LANDINGS: ReadonlySet<number> = new Set([MavCmd.NAV_LAND, MavCmd.NAV_VTOL_LAND]);

/** Returns whether the plan's vehicle flies on a wing. */
export function isWing(plan: Plan): boolean {
  return WINGS.has(plan.vehicleType);
}

/** Returns the indexes of items in the order of execution, with jumps, and whether the mission ends by itself. */
export function executionOrder(mission: readonly Item[]): { order: number[]; ends: boolean } {
  const left = new Map<number, number>();
  const order: number[] = [];
  let at = 0;
  for (let visits = 0; at < mission.length; visits++) {
    // Jumps count too: two that name one another never reach an item to fly.
    if (visits >= MAX_VISITS) return { order, ends: false };
    const each = mission[at]!;
    if (each.command !== MavCmd.DO_JUMP) {
      order.push(at);
      if (each.command === MavCmd.NAV_LOITER_UNLIM) return { order, ends: false };
      if (each.command === MavCmd.NAV_RETURN_TO_LAUNCH) return { order, ends: true };
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
  return { order, ends: true };
}

export function homePoint(plan: Plan): PathPoint | null {
  const home = plan.home;
  return home && { ...home, altitude: 0, item: -1, frame: MavFrame.GLOBAL_RELATIVE_ALT };
}

/** Returns the points that the vehicle flies to, from home, in the order of execution. */
export function pathOf(plan: Plan): PathPoint[] {
  const home = homePoint(plan);
  const points: PathPoint[] = home ? [home] : [];
  for (const index of executionOrder(plan.mission).order) points.push(...pointsOf(plan, index, points.at(-1) ?? null));
  return points;
}

/**
 * Returns the points of an item: none if the vehicle does not move.
 *
 * A takeoff or landing without a position happens where the vehicle is. A vehicle that hovers climbs before it
 * leaves, and descends where it lands; a wing climbs and descends on the way.
 */
export function pointsOf(plan: Plan, index: number, last: PathPoint | null): PathPoint[] {
  const each = plan.mission[index]!;
  if (each.command === MavCmd.NAV_RETURN_TO_LAUNCH) return returnPoints(plan, index, last);
  const [isTakeoff, isLanding] = [TAKEOFFS.has(each.command), LANDINGS.has(each.command)];
  const target = { item: index, altitude: each.params[6] ?? 0, frame: each.frame };
  const at = isOnPath(each) ? itemPosition(each) : isTakeoff || isLanding ? last : null;
  if (!at) return [];
  const point: PathPoint = { latitude: at.latitude, longitude: at.longitude, ...target };
  if (!isTakeoff && !isLanding) return [point];
  const touching = { ...point, touchesGround: true };
  if (!last || distance(last, point) < SAME_PLACE) return [touching];
  if (isWing(plan) && each.command !== MavCmd.NAV_VTOL_TAKEOFF && each.command !== MavCmd.NAV_VTOL_LAND)
    return [touching];
  if (isTakeoff) return [{ ...touching, latitude: last.latitude, longitude: last.longitude }, point];
  return [{ ...point, altitude: last.altitude, frame: last.frame }, touching];
}

function returnPoints(plan: Plan, index: number, last: PathPoint | null): PathPoint[] {
  const home = homePoint(plan);
  if (!home) return [];
  const keeps = last?.frame === MavFrame.GLOBAL_RELATIVE_ALT ? last.altitude : 0;
  const above = { ...home, altitude: keeps, item: index };
  return isWing(plan) ? [above] : [above, { ...home, item: index, touchesGround: true }];
}
