/** Metres north and east around an origin on the ellipsoid of WGS 84, as `mavstack.geodesy.LocalFrame` has them. */

import { wrapLongitude } from './geometry';

export interface Degrees {
  readonly latitude: number;
  readonly longitude: number;
}

/** Metres north and east. */
export type Corner = readonly [number, number];

const SEMI_MAJOR = 6_378_137;
const ECCENTRICITY_SQUARED = 6.694379990141e-3;
const RADIAN = Math.PI / 180;
const PASSES = 3;

/** Returns the metres of a radian along the meridian and along the parallel at a latitude in degrees. */
function radii(latitude: number): readonly [number, number] {
  const sine = Math.sin(latitude * RADIAN);
  const square = 1 - ECCENTRICITY_SQUARED * sine * sine;
  const along = (SEMI_MAJOR * (1 - ECCENTRICITY_SQUARED)) / (square * Math.sqrt(square));
  return [along, (SEMI_MAJOR / Math.sqrt(square)) * Math.cos(latitude * RADIAN)];
}

export function toMetres(origin: Degrees, { latitude, longitude }: Degrees): Corner {
  const [along, across] = radii((latitude + origin.latitude) / 2);
  const east = wrapLongitude(longitude - origin.longitude);
  return [(latitude - origin.latitude) * RADIAN * along, east * RADIAN * across];
}

export function toDegrees(origin: Degrees, [north, east]: Corner): Degrees {
  let latitude = origin.latitude + north / radii(origin.latitude)[0] / RADIAN;
  let across = 1;
  for (let pass = 0; pass < PASSES; pass += 1) {
    const [along, beside] = radii((latitude + origin.latitude) / 2);
    across = beside;
    latitude = Math.min(90, Math.max(-90, origin.latitude + north / along / RADIAN));
  }
  return { latitude, longitude: wrapLongitude(origin.longitude + east / across / RADIAN) };
}
