/** A corridor: lanes beside a line, such as a road or a pipeline. */

import { centre, fromLocal, toLocal, type Local, type Point } from './geo';
import { MAX_LANES, TOLERANCE, type Lane } from './pattern';

export interface CorridorOptions {
  /** Metres of the whole corridor. */
  readonly width: number;
  /** Metres between lanes. */
  readonly spacing: number;
  /** Begin at the other end of the line. */
  readonly reverse?: boolean;
}

/** Returns the lanes in the order of flight; each one is a path of as many points as the line has. */
export function corridorLanes(line: readonly Point[], options: CorridorOptions): Lane[] {
  if (line.length < 2 || !(options.spacing > 0) || !(options.width >= 0)) return [];
  const origin = centre(line);
  const path = (options.reverse ? [...line].reverse() : line).map((each) => toLocal(origin, each));
  const count = Math.max(1, Math.ceil(options.width / options.spacing - TOLERANCE));
  if (count > MAX_LANES) return [];
  return Array.from({ length: count }, (_, index) => {
    const lane = shifted(path, (index - (count - 1) / 2) * options.spacing);
    return (index % 2 ? lane.reverse() : lane).map((place) => fromLocal(origin, place));
  });
}

/** Returns the outline of a corridor. */
export function corridorOutline(line: readonly Point[], width: number): Point[] {
  if (line.length < 2) return [];
  const origin = centre(line);
  const path = line.map((each) => toLocal(origin, each));
  const sides = [...shifted(path, width / 2), ...shifted(path, -width / 2).reverse()];
  return sides.map((place) => fromLocal(origin, place));
}

/** The factor by which a sharp corner may lie farther from the line than the lane. */
const MAX_MITRE = 3;

/** Returns a path shifted to its right by some metres; corners are mitred. */
function shifted(path: readonly Local[], metres: number): Local[] {
  return path.map((place, index) => {
    const before = direction(path[Math.max(0, index - 1)]!, path[Math.max(1, index)]!);
    const after = direction(path[Math.min(path.length - 2, index)]!, path[Math.min(path.length - 1, index + 1)]!);
    const sum = { x: before.x + after.x, y: before.y + after.y };
    const length = Math.hypot(sum.x, sum.y);
    const middle = length < 1e-9 ? before : { x: sum.x / length, y: sum.y / length };
    const cosine = middle.x * before.x + middle.y * before.y;
    const out = metres * Math.min(MAX_MITRE, 1 / Math.max(cosine, 1e-9));
    return { x: place.x + middle.y * out, y: place.y - middle.x * out };
  });
}

function direction(from: Local, to: Local): Local {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  return length === 0 ? { x: 0, y: 1 } : { x: (to.x - from.x) / length, y: (to.y - from.y) / length };
}
