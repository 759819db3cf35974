/** Conversions between degrees and the metres of the demo. */

import { MavFrame } from '$generated';
import { EARTH_RADIUS } from '$lib/map/geometry';
import type { PlanItem } from '$lib/vehicle/Vehicle';

import type { Point } from './motion';
import { ORIGIN } from './profiles';

const METRES_PER_DEGREE = (EARTH_RADIUS * Math.PI) / 180;
const COSINE = Math.cos((ORIGIN.latitude * Math.PI) / 180);
const GLOBAL_FRAMES: ReadonlySet<number> = new Set([MavFrame.GLOBAL, MavFrame.GLOBAL_INT]);

export function toDegrees(point: Point): { latitude: number; longitude: number; altitude: number } {
  return {
    latitude: ORIGIN.latitude + point.north / METRES_PER_DEGREE,
    longitude: ORIGIN.longitude + point.east / (METRES_PER_DEGREE * COSINE),
    altitude: ORIGIN.altitude + point.up,
  };
}

export function toMetres(latitude: number, longitude: number, up: number): Point {
  return {
    north: (latitude - ORIGIN.latitude) * METRES_PER_DEGREE,
    east: (longitude - ORIGIN.longitude) * METRES_PER_DEGREE * COSINE,
    up,
  };
}

/** Returns the place of an item; one without a place is where the vehicle is. */
export function toPoint(item: PlanItem, home: Point, here: Point): Point {
  const [latitude, longitude, altitude] = item.params.slice(4);
  const above = GLOBAL_FRAMES.has(item.frame) ? (altitude ?? 0) - ORIGIN.altitude : (altitude ?? 0) + home.up;
  if (!latitude && !longitude) return { north: here.north, east: here.east, up: above };
  return toMetres(latitude ?? 0, longitude ?? 0, above);
}
