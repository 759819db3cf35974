/** Geometry on the globe (spherical, good to 0.5 %) and of the map's projection. Degrees and metres. */

export interface Place {
  readonly latitude: number;
  readonly longitude: number;
}

export interface Bounds {
  readonly south: number;
  readonly west: number;
  readonly north: number;
  readonly east: number;
}

/** The mean radius in metres, as in `mavstack.geodesy`. */
export const EARTH_RADIUS = 6_371_008.8;
/** The Mercator projection ends here. */
export const MAX_LATITUDE = 85.051129;

const RADIANS = Math.PI / 180;

/** Return the great-circle distance in metres. */
export function distance(from: Place, to: Place): number {
  const [latitude1, latitude2] = [from.latitude * RADIANS, to.latitude * RADIANS];
  const half = Math.sin((latitude2 - latitude1) / 2) ** 2;
  const turn = Math.sin(((to.longitude - from.longitude) * RADIANS) / 2) ** 2;
  const share = half + Math.cos(latitude1) * Math.cos(latitude2) * turn;
  return 2 * EARTH_RADIUS * Math.asin(Math.min(1, Math.sqrt(share)));
}

/** Return the initial bearing in degrees from true north, between 0 and 360. */
export function bearing(from: Place, to: Place): number {
  const [latitude1, latitude2] = [from.latitude * RADIANS, to.latitude * RADIANS];
  const turn = (to.longitude - from.longitude) * RADIANS;
  const east = Math.sin(turn) * Math.cos(latitude2);
  const north = Math.cos(latitude1) * Math.sin(latitude2) - Math.sin(latitude1) * Math.cos(latitude2) * Math.cos(turn);
  return (Math.atan2(east, north) / RADIANS + 360) % 360;
}

/** Return the place at a distance in metres and a bearing in degrees. */
export function destination(from: Place, direction: number, metres: number): Place {
  const angle = metres / EARTH_RADIUS;
  const latitude1 = from.latitude * RADIANS;
  const sine =
    Math.sin(latitude1) * Math.cos(angle) + Math.cos(latitude1) * Math.sin(angle) * Math.cos(direction * RADIANS);
  const latitude2 = Math.asin(Math.max(-1, Math.min(1, sine)));
  const turn = Math.atan2(
    Math.sin(direction * RADIANS) * Math.sin(angle) * Math.cos(latitude1),
    Math.cos(angle) - Math.sin(latitude1) * Math.sin(latitude2),
  );
  return { latitude: latitude2 / RADIANS, longitude: wrapLongitude(from.longitude + turn / RADIANS) };
}

/** Return a longitude between -180 (included) and 180 (excluded). */
export function wrapLongitude(longitude: number): number {
  return ((((longitude + 180) % 360) + 360) % 360) - 180;
}

/** Return the points of a circle, the first again at the end. */
export function circle(centre: Place, radius: number, corners = 72): Place[] {
  return Array.from({ length: corners + 1 }, (_, index) =>
    destination(centre, ((index % corners) * 360) / corners, radius),
  );
}

/** Return the smallest bounds around places, or null without any. Across the date line `east` is beyond 180. */
export function boundsOf(places: readonly Place[]): Bounds | null {
  const [first] = places;
  if (first === undefined) return null;
  let [south, north, west, east] = [first.latitude, first.latitude, first.longitude, first.longitude];
  for (const { latitude, longitude } of places) {
    // Counted from the first place on, so that a fleet at the date line is not drawn around the world.
    const near = first.longitude + wrapLongitude(longitude - first.longitude);
    south = Math.min(south, latitude);
    north = Math.max(north, latitude);
    west = Math.min(west, near);
    east = Math.max(east, near);
  }
  return { south, west, north, east };
}

/** Return bounds that are at least `metres` high and wide. */
export function widened(bounds: Bounds, metres: number): Bounds {
  const high = metres / (EARTH_RADIUS * RADIANS);
  const wide = high / Math.max(0.01, Math.cos(((bounds.south + bounds.north) / 2) * RADIANS));
  const upward = Math.max(0, high - (bounds.north - bounds.south)) / 2;
  const sideward = Math.max(0, wide - (bounds.east - bounds.west)) / 2;
  return {
    south: bounds.south - upward,
    north: bounds.north + upward,
    west: bounds.west - sideward,
    east: bounds.east + sideward,
  };
}

/** Return the length of a line through places in metres. */
export function pathLength(places: readonly Place[]): number {
  return places.reduce((sum, place, index) => (index === 0 ? 0 : sum + distance(places[index - 1]!, place)), 0);
}

/** Return x of the Mercator projection: 0 at longitude -180, 1 at 180. */
export function mercatorX(longitude: number): number {
  return (longitude + 180) / 360;
}

/** Return y of the Mercator projection: 0 in the north, 1 in the south. */
export function mercatorY(latitude: number): number {
  const sine = Math.sin(Math.max(-MAX_LATITUDE, Math.min(MAX_LATITUDE, latitude)) * RADIANS);
  return 0.5 - Math.log((1 + sine) / (1 - sine)) / (4 * Math.PI);
}

export function mercatorLatitude(y: number): number {
  return Math.atan(Math.sinh(Math.PI * (1 - 2 * y))) / RADIANS;
}

/** Pixels at the edges of a map. */
export interface Insets {
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
  readonly left: number;
}

/** Returns edges in pixels that leave a fifth of a box free: MapLibre refuses bounds without room. */
export function shrunk(edges: Insets, width: number, height: number): Insets {
  const [wide, high] = [edges.left + edges.right, edges.top + edges.bottom];
  const [x, y] = [Math.min(1, (width * 0.8) / Math.max(1, wide)), Math.min(1, (height * 0.8) / Math.max(1, high))];
  return { top: edges.top * y, bottom: edges.bottom * y, left: edges.left * x, right: edges.right * x };
}
