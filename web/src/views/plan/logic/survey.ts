/** A survey: parallel lanes over a polygon, which may be concave. */

import { centre, fromLocal, rotate, toLocal, type Local, type Point } from './geo';
import { MAX_LANES, TOLERANCE, type Lane } from './pattern';

export interface SurveyOptions {
  /** Metres between lanes. */
  readonly spacing: number;
  /** Heading of the lanes in degrees. */
  readonly angle: number;
  /** The corner to begin at: 0 to 3. */
  readonly start?: number;
  /** Fly a second set of lanes across the first one. */
  readonly crosshatch?: boolean;
}

/** Metres below which a lane is none. */
const MIN_LANE = 0.01;

/** Returns the lanes in the order of flight; an empty list if the spacing or the polygon is not possible. */
export function surveyLanes(polygon: readonly Point[], options: SurveyOptions): Lane[] {
  const lanes = oneDirection(polygon, options.spacing, options.angle, options.start ?? 0);
  if (!options.crosshatch || lanes.length === 0) return lanes;
  const across = oneDirection(polygon, options.spacing, options.angle + 90, options.start ?? 0);
  return across.length === 0 ? [] : [...lanes, ...across];
}

function oneDirection(polygon: readonly Point[], spacing: number, angle: number, start: number): Lane[] {
  if (polygon.length < 3 || !(spacing > 0)) return [];
  const origin = centre(polygon);
  // Turned so that the lanes run to the north (along y): a lane is a line of constant x.
  const places = polygon.map((each) => rotate(toLocal(origin, each), -angle));
  const west = Math.min(...places.map((each) => each.x));
  const width = Math.max(...places.map((each) => each.x)) - west;
  const count = Math.max(1, Math.ceil(width / spacing - TOLERANCE));
  if (count > MAX_LANES) return [];
  const margin = (width - (count - 1) * spacing) / 2;
  const rows = Array.from({ length: count }, (_, index) => crossings(places, west + margin + index * spacing));
  if (start & 1) rows.reverse();
  const back = (place: Local): Point => fromLocal(origin, rotate(place, angle));
  return rows.flatMap((row, index) => {
    const forward = (index % 2 === 0) !== Boolean(start & 2);
    const parts = forward ? row : row.map(([low, high]) => [high, low] as const).reverse();
    return parts.map(([from, to]) => [back(from), back(to)]);
  });
}

/** Returns the parts of the line of an x that are inside of a polygon, from south to north. */
function crossings(places: readonly Local[], x: number): (readonly [Local, Local])[] {
  const found: number[] = [];
  places.forEach((from, index) => {
    const to = places[(index + 1) % places.length]!;
    if (from.x <= x === to.x <= x) return;
    found.push(from.y + ((x - from.x) * (to.y - from.y)) / (to.x - from.x));
  });
  found.sort((a, b) => a - b);
  const parts: (readonly [Local, Local])[] = [];
  for (let index = 0; index + 1 < found.length; index += 2) {
    // A line that only touches a corner has no length inside.
    if (found[index + 1]! - found[index]! < MIN_LANE) continue;
    parts.push([
      { x, y: found[index]! },
      { x, y: found[index + 1]! },
    ]);
  }
  return parts;
}

/** Returns the angle of lanes along the longest edge, which needs the fewest turns for most areas. */
export function maxEdgeAngle(polygon: readonly Point[]): number {
  const origin = centre(polygon);
  const places = polygon.map((each) => toLocal(origin, each));
  let [longest, angle] = [0, 0];
  places.forEach((from, index) => {
    const to = places[(index + 1) % places.length]!;
    const length = Math.hypot(to.x - from.x, to.y - from.y);
    if (length > longest) [longest, angle] = [length, (Math.atan2(to.x - from.x, to.y - from.y) * 180) / Math.PI];
  });
  return Math.round(((angle % 180) + 180) % 180);
}
