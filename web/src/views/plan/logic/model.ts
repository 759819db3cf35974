/**
 * The plan that is edited: mission items, fence areas, rally points and the planned home.
 *
 * As in the server's API the home is not an item: items count from 0, and a DO_JUMP holds the index of its target.
 * All functions return new plans, so that a history of plans is a history of the edits.
 */

import { MavAutopilot, MavCmd, MavFrame, MavType } from '$generated';

import type { Json } from '../formats/json';
import type { Point } from './geo';

/** The frames that mean the same with `_INT` in their names. */
const PLAIN_FRAMES: Readonly<Record<number, number>> = {
  [MavFrame.GLOBAL_INT]: MavFrame.GLOBAL,
  [MavFrame.GLOBAL_RELATIVE_ALT_INT]: MavFrame.GLOBAL_RELATIVE_ALT,
  [MavFrame.GLOBAL_TERRAIN_ALT_INT]: MavFrame.GLOBAL_TERRAIN_ALT,
};

/** Seven params; null is NaN, which means that the vehicle chooses. */
export type Params = readonly (number | null)[];

export interface Item {
  readonly command: number;
  readonly frame: number;
  readonly params: Params;
  readonly autocontinue: boolean;
  /** A pattern of another program that has no items: it is kept for files, and no vehicle can take it. */
  readonly kept?: KeptPattern;
}

export interface KeptPattern {
  /** The name of its kind, such as `StructureScan`. */
  readonly kind: string;
  readonly json: Json;
}

/**
 * A survey or corridor, by its shape and settings: QGroundControl's ComplexItem without its items.
 *
 * It stands for the items of the mission that are still those that it was made of; once they are edited one by one,
 * they are plain items again.
 */
export interface Pattern {
  /** `survey`, `CorridorScan`, or a kind of QGroundControl that the page only keeps. */
  readonly kind: string;
  readonly json: Readonly<Record<string, Json>>;
  readonly items: readonly Item[];
}

export interface Polygon {
  readonly inclusion: boolean;
  readonly vertices: readonly Point[];
  /** The inclusion group, if it is not 0. */
  readonly group?: number;
}

export interface Circle {
  readonly inclusion: boolean;
  readonly center: Point;
  readonly radius: number;
  readonly group?: number;
}

/** A point with an altitude in metres. */
export interface Place extends Point {
  readonly altitude: number;
  /** The reference of a rally point or return point that is not relative to home. */
  readonly frame?: number;
}

export interface Plan {
  readonly home: Place | null;
  readonly mission: readonly Item[];
  /** The patterns of which items of the mission were made. */
  readonly patterns: readonly Pattern[];
  readonly polygons: readonly Polygon[];
  readonly circles: readonly Circle[];
  readonly returnPoint: Place | null;
  readonly rally: readonly Place[];
  /** Metres per second of a wing, and of a hovering vehicle. */
  readonly cruiseSpeed: number;
  readonly hoverSpeed: number;
  /** MAV_AUTOPILOT and MAV_TYPE of the vehicle, which `.plan` files hold. */
  readonly firmware: number;
  readonly vehicleType: number;
}

export type PlanKind = 'mission' | 'fence' | 'rally';

export const EMPTY_PLAN: Plan = {
  home: null,
  mission: [],
  patterns: [],
  polygons: [],
  circles: [],
  returnPoint: null,
  rally: [],
  cruiseSpeed: 15,
  hoverSpeed: 5,
  firmware: MavAutopilot.GENERIC,
  vehicleType: MavType.QUADROTOR,
};

export function plainFrame(frame: number): number {
  return PLAIN_FRAMES[frame] ?? frame;
}

/** Returns an item; missing params are 0. */
export function item(command: number, params: Params, frame: number = MavFrame.GLOBAL_RELATIVE_ALT): Item {
  const seven = Array.from({ length: 7 }, (_, index) => (index < params.length ? params[index]! : 0));
  return { command, frame: plainFrame(frame), params: seven, autocontinue: true };
}

/** Returns an item that stands for a pattern of another program. */
export function keptItem(kind: string, json: Json): Item {
  return { ...item(0, [], MavFrame.MISSION), kept: { kind, json } };
}

/** Returns a plan without the patterns of other programs, as vehicles and other formats take it. */
export function withoutKept(plan: Plan): Plan {
  const kept = plan.mission.flatMap((each, index) => (each.kept ? [index] : []));
  return kept.length ? removeItems(plan, new Set(kept)) : plan;
}

/** Returns a waypoint; its altitude in metres in the frame. */
export function waypoint(at: Point, altitude: number, frame: number = MavFrame.GLOBAL_RELATIVE_ALT): Item {
  return item(MavCmd.NAV_WAYPOINT, [0, 0, 0, null, at.latitude, at.longitude, altitude], frame);
}

/** Returns the position of an item; null if it has none, or means the vehicle's own position. */
export function positionOf(each: Item, hasLocation: boolean): Point | null {
  const [latitude, longitude] = [each.params[4], each.params[5]];
  if (!hasLocation || each.frame === MavFrame.MISSION || latitude == null || longitude == null) return null;
  return latitude === 0 && longitude === 0 ? null : { latitude, longitude };
}

/** Returns a copy of an item at another position. */
export function placedAt(each: Item, at: Point): Item {
  const params = [...each.params];
  [params[4], params[5]] = [at.latitude, at.longitude];
  return { ...each, params };
}

/** Returns a copy of an item with another param, from 1. */
export function withParam(each: Item, number: number, value: number | null): Item {
  const params = [...each.params];
  params[number - 1] = value;
  return { ...each, params };
}

/** Returns items with the targets of jumps mapped; a target that is gone becomes -1, which checks report. */
function withJumps(items: readonly Item[], target: (index: number) => number): Item[] {
  return items.map((each) => {
    const old = each.params[0];
    return each.command === MavCmd.DO_JUMP && old != null && old >= 0 ? withParam(each, 1, target(old)) : each;
  });
}

/** Inserts items so that the first one has an index. */
export function insertItems(plan: Plan, at: number, added: readonly Item[]): Plan {
  const moved = withJumps(plan.mission, (target) => (target >= at ? target + added.length : target));
  return { ...plan, mission: [...moved.slice(0, at), ...added, ...moved.slice(at)] };
}

export function replaceItem(plan: Plan, at: number, changed: Item): Plan {
  return { ...plan, mission: plan.mission.map((each, index) => (index === at ? changed : each)) };
}

export function removeItems(plan: Plan, indexes: ReadonlySet<number>): Plan {
  const gone = [...indexes];
  const target = (old: number): number => (indexes.has(old) ? -1 : old - gone.filter((each) => each < old).length);
  const kept = plan.mission.filter((_, index) => !indexes.has(index));
  return { ...plan, mission: withJumps(kept, target) };
}

/** Moves an item to another index; jumps follow the items that they name. */
export function moveItem(plan: Plan, from: number, to: number): Plan {
  const order = plan.mission.map((_, index) => index);
  const [moved] = order.splice(from, 1);
  if (moved === undefined) return plan;
  order.splice(Math.max(0, Math.min(to, order.length)), 0, moved);
  const items = order.map((old) => plan.mission[old]!);
  return { ...plan, mission: withJumps(items, (old) => order.indexOf(old)) };
}

/** Moves one vertex, or removes it where `to` is null; a polygon of less than three vertices is removed. */
export function moveVertex(plan: Plan, polygon: number, vertex: number, to: Point | null): Plan {
  const changed = plan.polygons.map((each, index) => {
    if (index !== polygon) return each;
    const vertices = to
      ? each.vertices.map((old, at) => (at === vertex ? to : old))
      : each.vertices.filter((_, at) => at !== vertex);
    return { ...each, vertices };
  });
  return { ...plan, polygons: changed.filter((each) => each.vertices.length >= 3) };
}

export function insertVertex(plan: Plan, polygon: number, before: number, at: Point): Plan {
  const polygons = plan.polygons.map((each, index) =>
    index === polygon
      ? { ...each, vertices: [...each.vertices.slice(0, before), at, ...each.vertices.slice(before)] }
      : each,
  );
  return { ...plan, polygons };
}

/** Returns a copy of a list without the member at an index. */
export function without<T>(list: readonly T[], at: number): T[] {
  return list.filter((_, index) => index !== at);
}

/** Returns a copy of a list with another member at an index. */
export function changedAt<T>(list: readonly T[], at: number, value: T): T[] {
  return list.map((each, index) => (index === at ? value : each));
}

export function isEmpty(plan: Plan, kind: PlanKind): boolean {
  if (kind === 'mission') return plan.mission.length === 0;
  if (kind === 'rally') return plan.rally.length === 0;
  return plan.polygons.length + plan.circles.length === 0 && plan.returnPoint === null;
}
