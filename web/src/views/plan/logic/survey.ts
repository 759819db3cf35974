/** A survey: parallel lanes over a polygon, which may be concave, by the planner of the station and of Python. */

import { toDegrees, toMetres } from '$lib/map/localFrame';

import { bestBearing, cover, orderTracks, ringSize, toSweep, type Track } from './areas';
import type { Point } from './geo';
import { MAX_LANES, type Lane } from './pattern';

export interface SurveyOptions {
  /** Metres between lanes, at most. */
  readonly spacing: number;
  /** Heading of the lanes in degrees. */
  readonly angle: number;
  /** The corner to begin at: 0 to 3. */
  readonly start?: number;
  /** Fly a second set of lanes across the first one. */
  readonly crosshatch?: boolean;
  /** Metres that a wing needs for a turn; lanes are interleaved. */
  readonly turnRadius?: number;
  /** Regions that are left out. */
  readonly obstacles?: readonly (readonly Point[])[];
}

/** Square metres below which a polygon has no area. */
const MIN_SIZE = 0.01;
/** Metres below which a lane only touches a corner. */
const MIN_LANE = 0.01;

/** Returns the lanes in the order of flight; an empty list if the spacing or the polygon is not possible. */
export function surveyLanes(polygon: readonly Point[], options: SurveyOptions): Lane[] {
  const { spacing, angle, start = 0, turnRadius = 0, obstacles = [] } = options;
  const origin = polygon[0];
  if (origin === undefined || polygon.length < 3 || !(spacing > 0)) return [];
  const rings = [polygon, ...obstacles].map((ring) => ring.map((each) => toMetres(origin, each)));
  if (ringSize(rings[0]!) < MIN_SIZE) return [];
  const ordered: Track[] = [];
  for (const bearing of options.crosshatch ? [angle, angle + 90] : [angle]) {
    const cells = cover(rings, spacing, bearing, MAX_LANES);
    if (cells.length === 0) return [];
    // The first corner is the one at which the planner begins by itself.
    const from = ordered.at(-1)?.end ?? (start > 0 ? cornerOf(rings[0]!, angle, start) : null);
    ordered.push(...orderTracks(cells, from, turnRadius));
  }
  return ordered
    .filter((track) => Math.hypot(track.end[0] - track.start[0], track.end[1] - track.start[1]) >= MIN_LANE)
    .map((track) => [toDegrees(origin, track.start), toDegrees(origin, track.end)]);
}

/** Returns a corner of the box around an area, along the lanes: bit 0 is the right side, bit 1 the far end. */
function cornerOf(outline: Parameters<typeof toSweep>[0], angle: number, start: number): readonly [number, number] {
  const swept = toSweep(outline, angle);
  const pick = (values: number[], isHigh: boolean): number => (isHigh ? Math.max(...values) : Math.min(...values));
  const along = swept.map(([each]) => each);
  const across = swept.map(([, each]) => each);
  return toSweep([[pick(along, (start & 2) !== 0), pick(across, (start & 1) !== 0)]], -angle)[0]!;
}

/** Returns the angle of lanes that needs the fewest turns. */
export function fewestLanesAngle(polygon: readonly Point[]): number {
  const origin = polygon[0];
  if (origin === undefined || polygon.length < 3) return 0;
  return Math.round(bestBearing(polygon.map((each) => toMetres(origin, each)))) % 180;
}
