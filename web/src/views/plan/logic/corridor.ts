/** A corridor: lanes beside a line, such as a road or a pipeline. */

import { toDegrees, toMetres } from '$lib/map/localFrame';

import type { Local, Point } from './geo';
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
  const origin = line[0] ?? { latitude: 0, longitude: 0 };
  const path = placesOf(origin, options.reverse ? [...line].reverse() : line);
  if (path.length < 2 || !(options.spacing > 0) || !(options.width >= 0)) return [];
  const count = Math.max(1, Math.ceil(options.width / options.spacing - TOLERANCE));
  if (count > MAX_LANES) return [];
  return Array.from({ length: count }, (_, index) => {
    const lane = shifted(path, ((index + 0.5) / count - 0.5) * options.width);
    return (index % 2 ? lane.reverse() : lane).map((place) => placeAt(origin, place));
  });
}

/** Returns the outline of a corridor. */
export function corridorOutline(line: readonly Point[], width: number): Point[] {
  const origin = line[0] ?? { latitude: 0, longitude: 0 };
  const path = placesOf(origin, line);
  if (path.length < 2) return [];
  const sides = [...shifted(path, width / 2), ...shifted(path, -width / 2).reverse()];
  return sides.map((place) => placeAt(origin, place));
}

const placeAt = (origin: Point, { x, y }: Local): Point => toDegrees(origin, [y, x]);

/** The factor by which a sharp corner may lie farther from the line than the lane. */
const MAX_MITRE = 3;

/** Metres below which two points of a line are one, as those of a double click are. */
const MIN_SEGMENT = 0.01;

function placesOf(origin: Point, line: readonly Point[]): Local[] {
  const places = line.map((each): Local => {
    const [y, x] = toMetres(origin, each);
    return { x, y };
  });
  return places.filter((place, index) => {
    const before = places[index - 1];
    return before === undefined || Math.hypot(place.x - before.x, place.y - before.y) >= MIN_SEGMENT;
  });
}

/** Returns a path shifted to its right by some metres; corners are mitred. */
function shifted(path: readonly Local[], metres: number): Local[] {
  return path.map((place, index) => {
    const before = direction(path[Math.max(0, index - 1)]!, path[Math.max(1, index)]!);
    const after = direction(path[Math.min(path.length - 2, index)]!, path[Math.min(path.length - 1, index + 1)]!);
    const sum = { x: before.x + after.x, y: before.y + after.y };
    const length = Math.hypot(sum.x, sum.y);
    const middle = length < 1e-9 ? before : { x: sum.x / length, y: sum.y / length };
    const cosine = middle.x * before.x + middle.y * before.y;
    const out =
      Math.sign(metres) *
      Math.min(
        Math.abs(metres) * Math.min(MAX_MITRE, 1 / Math.max(cosine, 1e-9)),
        innerLimit(path, index, metres * (before.x * after.y - before.y * after.x) < 0, cosine),
      );
    return { x: place.x + middle.y * out, y: place.y - middle.x * out };
  });
}

/** Returns how far the inner side of a corner may move: not beyond the other ends of its segments. */
function innerLimit(path: readonly Local[], index: number, isInner: boolean, cosine: number): number {
  const [before, at, after] = [path[index - 1], path[index]!, path[index + 1]];
  if (!isInner || !before || !after) return Infinity;
  const shortest = Math.min(Math.hypot(at.x - before.x, at.y - before.y), Math.hypot(after.x - at.x, after.y - at.y));
  return shortest / Math.max(Math.sqrt(1 - Math.min(1, cosine ** 2)), 1e-9);
}

function direction(from: Local, to: Local): Local {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  return length === 0 ? { x: 0, y: 1 } : { x: (to.x - from.x) / length, y: (to.y - from.y) / length };
}
