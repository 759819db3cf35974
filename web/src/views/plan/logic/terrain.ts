/** The altitude profile of a mission above the terrain. */

import { MavFrame } from '$generated';

import type { Plan } from './model';
import { between, distance, type Point } from './geo';
import type { ElevationSource } from './elevation';
import { pathOf, type PathPoint } from './path';

export interface ProfilePoint {
  /** Metres from the begin of the path. */
  readonly distance: number;
  /** The item that the vehicle flies to, -1 for home. */
  readonly item: number;
  /** Metres above mean sea level; null: not known. */
  readonly altitude: number | null;
  readonly ground: number | null;
  /** Metres above the ground; null: not known. */
  readonly clearance: number | null;
}

export interface Profile {
  readonly points: readonly ProfilePoint[];
  /** The point with the smallest clearance, apart from takeoffs and landings; null: not known. */
  readonly lowest: ProfilePoint | null;
  /** The part of the path whose terrain is known, 0 to 1. */
  readonly known: number;
}

/** Metres between samples, and the largest number of samples. */
const STEP = 30;
const MAX_SAMPLES = 2000;
/** Metres over ground of a leg that goes up or down only, as a takeoff does. */
const VERTICAL_LEG = 5;

interface Sample extends Point {
  readonly distance: number;
  /** The ends of the leg, and how much of it is flown, 0 to 1. */
  readonly from: PathPoint;
  readonly to: PathPoint;
  readonly part: number;
  /** The samples of takeoffs and landings touch the ground on purpose. */
  readonly vertical: boolean;
}

/** Returns the profile of a plan's mission. */
export async function profileOf(plan: Plan, elevation: ElevationSource): Promise<Profile> {
  const samples = samplesOf(pathOf(plan));
  const home = plan.home;
  const heights = await elevation(home ? [home, ...samples] : samples);
  const homeGround = home ? heights.shift()! : null;
  const homeAltitude = homeGround ?? (home && home.altitude !== 0 ? home.altitude : null);
  const points = samples.map((sample, index) => pointOf(sample, heights[index] ?? null, homeAltitude));
  const checked = points.filter((point, index) => point.clearance !== null && !samples[index]!.vertical);
  return {
    points,
    lowest: checked.reduce<ProfilePoint | null>(
      (low, each) => (low && low.clearance! <= each.clearance! ? low : each),
      null,
    ),
    known: points.length ? points.filter((each) => each.clearance !== null).length / points.length : 0,
  };
}

function samplesOf(path: readonly PathPoint[]): Sample[] {
  const lengths = path.slice(1).map((point, index) => distance(path[index]!, point));
  const total = lengths.reduce((sum, each) => sum + each, 0);
  const step = Math.max(STEP, total / MAX_SAMPLES);
  const samples: Sample[] = path.slice(0, 1).map((first) => ({
    latitude: first.latitude,
    longitude: first.longitude,
    distance: 0,
    from: first,
    to: first,
    part: 1,
    vertical: true,
  }));
  let start = 0;
  lengths.forEach((length, index) => {
    const [from, to] = [path[index]!, path[index + 1]!];
    const count = Math.max(1, Math.ceil(length / step));
    for (let at = 1; at <= count; at += 1) {
      const part = at / count;
      const vertical = length < VERTICAL_LEG || to.touchesGround === true;
      samples.push({ ...between(from, to, part), from, to, part, distance: start + length * part, vertical });
    }
    start += length;
  });
  return samples;
}

function pointOf(sample: Sample, ground: number | null, homeAltitude: number | null): ProfilePoint {
  const altitude = absolute(sample, ground, homeAltitude);
  const clearance = altitude === null || ground === null ? null : altitude - ground;
  return { distance: sample.distance, item: sample.to.item, altitude, ground, clearance };
}

/** Returns the altitude of a sample, between those of both ends of its leg above the same reference. */
function absolute({ from, to, part }: Sample, ground: number | null, homeAltitude: number | null): number | null {
  const [first, last] = [above(from, ground, homeAltitude), above(to, ground, homeAltitude)];
  // An end whose reference is not known cannot be mixed in: the target's altitude holds on the whole leg.
  return first === null || last === null ? last : first + (last - first) * part;
}

/** Returns the altitude above mean sea level that a point would have over some ground; null: not known. */
function above(point: PathPoint, ground: number | null, homeAltitude: number | null): number | null {
  if (point.frame === MavFrame.GLOBAL) return point.altitude;
  const base = point.frame === MavFrame.GLOBAL_TERRAIN_ALT ? ground : homeAltitude;
  return base === null ? null : base + point.altitude;
}
