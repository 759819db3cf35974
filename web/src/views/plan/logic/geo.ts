/** Geometry of plans: that of the map on the globe, and a tangent plane for areas of some kilometres. */

import { destination, distance, EARTH_RADIUS, wrapLongitude as wrap } from '$lib/map/geometry';

export { bearing, destination, distance } from '$lib/map/geometry';

export interface Point {
  readonly latitude: number;
  readonly longitude: number;
}

/** Metres east and north of an origin. */
export interface Local {
  readonly x: number;
  readonly y: number;
}

const DEGREE = Math.PI / 180;

/** Returns the point between two points; `part` is 0 at the first and 1 at the second one. */
export function between(from: Point, to: Point, part = 0.5): Point {
  const east = wrap(to.longitude - from.longitude);
  return {
    latitude: from.latitude + (to.latitude - from.latitude) * part,
    longitude: wrap(from.longitude + east * part),
  };
}

/** Returns a point in the tangent plane of an origin. */
export function toLocal(origin: Point, point: Point): Local {
  return {
    x: wrap(point.longitude - origin.longitude) * DEGREE * EARTH_RADIUS * Math.cos(origin.latitude * DEGREE),
    y: (point.latitude - origin.latitude) * DEGREE * EARTH_RADIUS,
  };
}

/** Returns the centre of the bounding box of points. */
export function centre(points: readonly Point[]): Point {
  const first = points[0] ?? { latitude: 0, longitude: 0 };
  const east = points.map((each) => wrap(each.longitude - first.longitude));
  const north = points.map((each) => each.latitude);
  if (points.length === 0) return first;
  return {
    latitude: (Math.min(...north) + Math.max(...north)) / 2,
    longitude: wrap(first.longitude + (Math.min(...east) + Math.max(...east)) / 2),
  };
}

/** Returns the area of a polygon in square metres. */
export function area(polygon: readonly Point[]): number {
  const origin = centre(polygon);
  const places = polygon.map((each) => toLocal(origin, each));
  let twice = 0;
  places.forEach((place, index) => {
    const next = places[(index + 1) % places.length]!;
    twice += place.x * next.y - next.x * place.y;
  });
  return Math.abs(twice) / 2;
}

/** Returns whether a point is inside of a polygon. */
export function contains(polygon: readonly Point[], point: Point): boolean {
  let inside = false;
  const places = polygon.map((each) => toLocal(point, each));
  places.forEach((place, index) => {
    const next = places[(index + 1) % places.length]!;
    if (place.y > 0 === next.y > 0) return;
    if (place.x + ((next.x - place.x) * -place.y) / (next.y - place.y) > 0) inside = !inside;
  });
  return inside;
}

/** Returns whether two segments cross in the interior of both. */
export function crosses(a: Local, b: Local, c: Local, d: Local): boolean {
  const side = (p: Local, q: Local, r: Local): number => (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

/** Returns whether edges of a polygon cross one another. */
export function crossesItself(polygon: readonly Point[]): boolean {
  const origin = centre(polygon);
  const places = polygon.map((each) => toLocal(origin, each));
  const edges = places.map((place, index) => [place, places[(index + 1) % places.length]!] as const);
  return edges.some(([a, b], index) => edges.slice(index + 1).some(([c, d]) => crosses(a, b, c, d)));
}

/** Returns the length of a path in metres. */
export function pathLength(points: readonly Point[]): number {
  return points.slice(1).reduce((sum, point, index) => sum + distance(points[index]!, point), 0);
}

/** The place on the edge of a circle to drag its radius by: to the east of its centre. */
export function radiusHandle(center: Point, radius: number): Point {
  return destination(center, 90, radius);
}
