/** The length, duration and energy of a mission, from the path that the vehicle flies. */

import { MavCmd, MavFrame, MavVtolState, SpeedType } from '$generated';

import type { Item, Plan } from './model';
import { bearing, distance } from './geo';
import { executionOrder, homePoint, isWing, pointsOf, type PathPoint } from './path';

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

/** Metres per second. */
const MIN_SPEED = 0.1;
/** The speed of DO_CHANGE_SPEED by which the vehicle returns to its own. */
const DEFAULT_SPEED = -2;

/** Returns the speeds of a plan's vehicle. */
export function speedsOf(plan: Plan): FlightSpeeds {
  const speed = isWing(plan) ? plan.cruiseSpeed : plan.hoverSpeed;
  return { horizontal: Math.max(MIN_SPEED, speed), up: 2.5, down: 1.5 };
}

/** Seconds and metres that an item adds at its position. */
function stay(each: Item, speed: number): { seconds: number; metres: number } {
  const [first, , third] = each.params;
  if (each.command === MavCmd.NAV_LOITER_TURNS) {
    const metres = 2 * Math.PI * Math.abs(third || 0) * Math.abs(first ?? 0);
    return { seconds: metres / speed, metres };
  }
  const waits: number[] = [
    MavCmd.NAV_WAYPOINT,
    MavCmd.NAV_LOITER_TIME,
    MavCmd.NAV_DELAY,
    MavCmd.NAV_SPLINE_WAYPOINT,
    MavCmd.CONDITION_DELAY,
  ];
  return { seconds: waits.includes(each.command) ? Math.max(0, first ?? 0) : 0, metres: 0 };
}

function legOf(from: PathPoint, to: PathPoint, speeds: FlightSpeeds): Leg {
  const length = distance(from, to);
  const climb = from.frame === to.frame ? to.altitude - from.altitude : null;
  const vertical = climb === null ? 0 : climb > 0 ? climb / speeds.up : -climb / speeds.down;
  const speed = speeds.horizontal;
  const duration = Math.max(length / speed, vertical);
  return { from, to, length, bearing: bearing(from, to), climb, speed, duration };
}

/** Returns the speeds after an item. */
function speedsAfter(plan: Plan, each: Item, speeds: FlightSpeeds, defaults: FlightSpeeds): FlightSpeeds {
  if (each.command === MavCmd.DO_VTOL_TRANSITION) {
    if (each.params[0] === MavVtolState.MC) return { ...speeds, horizontal: Math.max(MIN_SPEED, plan.hoverSpeed) };
    return each.params[0] === MavVtolState.FW
      ? { ...speeds, horizontal: Math.max(MIN_SPEED, plan.cruiseSpeed) }
      : speeds;
  }
  if (each.command !== MavCmd.DO_CHANGE_SPEED) return speeds;
  const [type, speed] = [each.params[0] ?? 0, each.params[1] ?? -1];
  const key = type === SpeedType.CLIMB_SPEED ? 'up' : type === SpeedType.DESCENT_SPEED ? 'down' : 'horizontal';
  if (speed === DEFAULT_SPEED) return { ...speeds, [key]: defaults[key] };
  return speed > 0 ? { ...speeds, [key]: speed } : speeds;
}

/** Counts the pictures of a camera that is triggered by distance: one at the begin, one after each interval. */
class PictureCounter {
  count = 0;
  private interval = 0;
  private flown = 0;

  take(each: Item): void {
    if (each.command !== MavCmd.DO_SET_CAM_TRIGG_DIST) return;
    this.finish();
    this.interval = Math.max(0, each.params[0] ?? 0);
  }

  fly(metres: number): void {
    this.flown += metres;
  }

  finish(): void {
    if (this.interval > 0 && this.flown > 0) this.count += Math.floor(this.flown / this.interval) + 1;
    this.flown = 0;
  }
}

/** Returns the statistics of a plan's mission. */
export function statisticsOf(plan: Plan, speeds: FlightSpeeds = speedsOf(plan)): Statistics {
  const { order, ends } = executionOrder(plan.mission);
  const legs: Leg[] = [];
  const camera = new PictureCounter();
  let last = homePoint(plan);
  let [now, extraMetres, extraSeconds] = [speeds, 0, 0];
  for (const index of order) {
    const each = plan.mission[index]!;
    now = speedsAfter(plan, each, now, speeds);
    camera.take(each);
    for (const to of pointsOf(plan, index, last)) {
      if (last) legs.push(legOf(last, to, now));
      if (last) camera.fly(legs.at(-1)!.length);
      last = to;
    }
    const { seconds, metres } = stay(each, now.horizontal);
    [extraSeconds, extraMetres] = [extraSeconds + seconds, extraMetres + metres];
  }
  camera.finish();
  const sum = (values: readonly number[]): number => values.reduce((total, value) => total + value, 0);
  return {
    legs,
    distance: sum(legs.map((leg) => leg.length)) + extraMetres,
    duration: ends ? sum(legs.map((leg) => leg.duration)) + extraSeconds : null,
    ...extremes(plan, legs),
    itemCount: plan.mission.length,
    pictures: camera.count,
  };
}

function extremes(plan: Plan, legs: readonly Leg[]): Pick<Statistics, 'maxAltitude' | 'farthest' | 'longestLeg'> {
  const points = legs.map((leg) => leg.to);
  const relative = points
    .filter((point) => point.frame === MavFrame.GLOBAL_RELATIVE_ALT)
    .map((point) => point.altitude);
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
