/**
 * The places that the map fits itself to, and when it does so by itself: while they and the panels
 * beside the map are still coming, and when a vehicle has left the map that the user has not moved.
 */
import { circle, type Place } from '$lib/map/geometry';
import type { FenceShape, Stop } from '$lib/map/plan';
import type { View } from '$lib/map/projection';
import { Projection } from '$lib/map/projection';
import type { VehicleState } from '$lib/vehicle/Vehicle';

interface Edges {
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
  readonly left: number;
}

/** Time in ms after the first vehicle in which others, and the sizes of panels, become known. */
const SETTLING_TIME = 3000;
/** So few vehicles are shown whenever one more is found. */
const MAX_SMALL_FLEET = 8;
/** Time in ms between two fits to vehicles that left the map. */
const AWAY_INTERVAL = 2000;
/** The least that a map shows in m, and the time in s that a vehicle needs to leave it. */
const MIN_SPAN = 80;
const SPAN_TIME = 40;
/** A circle is shown whole if so many of its points are. */
const CIRCLE_POINTS = 8;

/** Returns the places of a plan that the map shows, whole circles included. */
export function planPlaces(stops: readonly Stop[], fence: readonly FenceShape[], rally: readonly Place[]): Place[] {
  const around = (centre: Place, radius: number): Place[] => circle(centre, Math.abs(radius), CIRCLE_POINTS);
  return [
    ...stops.flatMap((stop) => [stop, ...(stop.radius ? around(stop, stop.radius) : [])]),
    ...fence.flatMap((shape) => {
      if (shape.kind === 'polygon') return shape.corners;
      return shape.kind === 'circle' ? around(shape.centre, shape.radius) : [shape.place];
    }),
    ...rally,
  ];
}

/** Returns how much the map shows at least, in m: vehicles must not leave it within seconds. */
export function spanOf(states: readonly Pick<VehicleState, 'groundSpeed'>[]): number {
  return Math.max(MIN_SPAN, ...states.map(({ groundSpeed }) => (groundSpeed ?? 0) * SPAN_TIME));
}

/** Returns whether one of the places is not on the map, or covered by panels. */
export function isAnyAway(places: readonly Place[], view: View, edges: Edges): boolean {
  const projection = new Projection(view);
  return places.some(({ latitude, longitude }) => {
    const { x, y } = projection.toPixel(latitude, longitude);
    return x < edges.left || y < edges.top || x > view.width - edges.right || y > view.height - edges.bottom;
  });
}

export class Fitting {
  private count = 0;
  private edges = '';
  private since = 0;
  private fitted = 0;

  /** Forgets the fleet: the link was left. */
  reset(): void {
    this.count = 0;
  }

  /**
   * Returns whether the map shall show all vehicles now.
   *
   * @param count - Vehicles whose positions are known.
   * @param edges - What the panels cover, as text.
   * @param isFree - The user has not moved the map, and it follows no vehicle.
   * @param isAway - A vehicle is not on the map.
   */
  wants(count: number, edges: string, isFree: boolean, now: number, isAway = false): boolean {
    if (count === 0) return false;
    const isFirst = this.count === 0;
    if (isFirst) this.since = now;
    const isSettling = now - this.since < SETTLING_TIME;
    const hasMore = count > this.count && (isSettling || this.count < MAX_SMALL_FLEET);
    const hasMoved = isSettling && edges !== this.edges;
    const hasLeft = isAway && now - this.fitted >= AWAY_INTERVAL;
    if (!isFirst && !(isFree && (hasMore || hasMoved || hasLeft))) return false;
    this.fitted = now;
    this.count = count;
    this.edges = edges;
    return true;
  }
}
