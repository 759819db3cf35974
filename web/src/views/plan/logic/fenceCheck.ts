/**
 * Whether a place or a leg is within the fence.
 *
 * A fence without areas to stay in allows all places that no area forbids. With several of them PX4 asks that a place
 * is in each (its older versions: in one), and ignores an area that does not allow home. ArduPilot asks for each too,
 * or for one if FENCE_OPTIONS has the bit "union of inclusion areas".
 */

import { contains, distance, toLocal, type Local, type Point } from './geo';
import type { Circle, Plan, Polygon } from './model';

/** The part of a leg by which two crossings must differ to be two. */
const MIN_PART = 1e-6;

/** Whether a place is in all areas to stay in, in some of them only, or where it may not be at all. */
export type Grade = 'allowed' | 'partly' | 'forbidden';

/** Returns whether one area of a fence allows a place. */
export function allows(area: Polygon | Circle, point: Point): boolean {
  const isIn = 'vertices' in area ? contains(area.vertices, point) : distance(area.center, point) <= area.radius;
  return isIn === area.inclusion;
}

/** Returns what a fence makes of a place. */
export function gradeOf(plan: Plan, point: Point): Grade {
  const areas = [...plan.polygons, ...plan.circles];
  if (areas.some((each) => !each.inclusion && !allows(each, point))) return 'forbidden';
  const inclusions = areas.filter((each) => each.inclusion);
  const count = inclusions.filter((each) => allows(each, point)).length;
  if (count === inclusions.length) return 'allowed';
  return count > 0 ? 'partly' : 'forbidden';
}

/** Returns whether some part of the leg between two points is not allowed. */
export function legLeaves(plan: Plan, from: Point, to: Point, allowed: (point: Point) => boolean): boolean {
  const parts = [
    ...plan.polygons.flatMap(({ vertices }) => polygonCrossings(vertices, from, to)),
    ...plan.circles.flatMap((circle) => circleCrossings(circle, from, to)),
  ];
  const borders = [0, ...parts.filter((part) => part > 0 && part < 1).sort((a, b) => a - b), 1];
  return borders.slice(1).some((part, index) => {
    const before = borders[index]!;
    return part - before > MIN_PART && !allowed(along(from, to, (before + part) / 2));
  });
}

/** Returns the point at a part of the leg, in the plane that the crossings are found in. */
function along(from: Point, to: Point, part: number): Point {
  const east = ((to.longitude - from.longitude + 540) % 360) - 180;
  return { latitude: from.latitude + (to.latitude - from.latitude) * part, longitude: from.longitude + east * part };
}

/** Returns where a leg crosses the edges of a polygon, as parts of the leg. */
function polygonCrossings(vertices: readonly Point[], from: Point, to: Point): number[] {
  const places = vertices.map((each) => toLocal(from, each));
  const end = toLocal(from, to);
  return places.flatMap((place, index) => edgeCrossing(end, place, places[(index + 1) % places.length]!));
}

/** Returns the part of the way from the origin to `end` at which it meets an edge; corners belong to both edges. */
function edgeCrossing(end: Local, a: Local, b: Local): number[] {
  const edge = { x: b.x - a.x, y: b.y - a.y };
  const across = end.x * edge.y - end.y * edge.x;
  if (across === 0) return [];
  const part = (a.x * edge.y - a.y * edge.x) / across;
  const onEdge = (a.x * end.y - a.y * end.x) / across;
  return onEdge >= 0 && onEdge <= 1 ? [part] : [];
}

function circleCrossings(circle: Circle, from: Point, to: Point): number[] {
  const [a, b] = [toLocal(circle.center, from), toLocal(circle.center, to)];
  const [x, y] = [b.x - a.x, b.y - a.y];
  const [square, half] = [x * x + y * y, a.x * x + a.y * y];
  const root = half * half - square * (a.x * a.x + a.y * a.y - circle.radius ** 2);
  if (square === 0 || root <= 0) return [];
  return [(-half - Math.sqrt(root)) / square, (-half + Math.sqrt(root)) / square];
}
