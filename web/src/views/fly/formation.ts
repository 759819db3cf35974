/** Where each vehicle of a group goes when the group is sent to one place, and which of them would come too close. */
import { bearing, destination, distance, type Place } from '$lib/map/geometry';
import type { VehicleState } from '$lib/vehicle/Vehicle';

export interface Spot {
  readonly system: number;
  readonly place: Place;
  /** Above the vehicle's own home in m; undefined: the present one. */
  readonly altitude: number | undefined;
}

/** A pair of vehicles whose places are too close, with their distances in m. */
export interface Conflict {
  readonly systems: readonly [number, number];
  readonly horizontal: number;
  /** Null: not known. */
  readonly vertical: number | null;
}

type Member = Pick<VehicleState, 'system' | 'type' | 'position'>;

/** Vehicles that come closer than this both horizontally and vertically are too close. */
export const MIN_SEPARATION = 5;
/** Wings circle their place: their circles must be apart, or one above the other. */
const WING_SEPARATION = { horizontal: 200, vertical: 15 };
const isWing = ({ type }: Member): boolean => type === 'plane' || type === 'vtol';

/** Returns the middle of the group's positions, or null without any. */
export function centreOf(members: readonly Member[]): Place | null {
  const [first, ...others] = members.map(({ position }) => position).filter((position) => position !== null);
  if (first === undefined) return null;
  const offsets = others.map((place) => offsetOf(first, place));
  const count = offsets.length + 1;
  const [north, east] = [0, 1].map((axis) => offsets.reduce((sum, offset) => sum + offset[axis]!, 0) / count);
  return moved(first, [north!, east!]);
}

/** Returns the spot of each vehicle: the place itself, or in formation with its offset from the group's middle. */
export function spotsOf(
  members: readonly Member[],
  place: Place,
  { altitude, keepsFormation }: { altitude?: number | undefined; keepsFormation: boolean },
): Spot[] {
  const centre = keepsFormation ? centreOf(members) : null;
  return members.map(({ system, position }) => {
    const isOffset = centre !== null && position !== null;
    return { system, altitude, place: isOffset ? moved(place, offsetOf(centre, position)) : place };
  });
}

/** Returns the pairs of vehicles that would be too close at their spots. */
export function conflictsOf(members: readonly Member[], spots: readonly Spot[]): Conflict[] {
  const found: Conflict[] = [];
  members.forEach((one, index) => {
    for (let next = index + 1; next < members.length; next += 1) {
      const conflict = conflictOf([one, spots[index]!], [members[next]!, spots[next]!]);
      if (conflict !== null) found.push(conflict);
    }
  });
  return found;
}

function conflictOf(
  [one, spot]: readonly [Member, Spot],
  [other, otherSpot]: readonly [Member, Spot],
): Conflict | null {
  const hasWing = isWing(one) || isWing(other);
  const minimum = hasWing ? WING_SEPARATION : { horizontal: MIN_SEPARATION, vertical: MIN_SEPARATION };
  const horizontal = distance(spot.place, otherSpot.place);
  const [height, otherHeight] = [heightOf(one, spot), heightOf(other, otherSpot)];
  const vertical = height === null || otherHeight === null ? null : Math.abs(height - otherHeight);
  if (horizontal >= minimum.horizontal || (vertical !== null && vertical >= minimum.vertical)) return null;
  return { systems: [one.system, other.system], horizontal, vertical };
}

/** Returns a height that vehicles with different homes share: above sea, or above home where that is not known. */
function heightOf({ position }: Member, { altitude }: Spot): number | null {
  if (position === null) return null;
  const { altitude: sea, relativeAltitude } = position;
  if (altitude === undefined) return sea ?? relativeAltitude;
  return sea === null || relativeAltitude === null ? altitude : sea - relativeAltitude + altitude;
}

/** Returns metres to the north and to the east. */
function offsetOf(from: Place, to: Place): readonly [number, number] {
  const [metres, direction] = [distance(from, to), (bearing(from, to) * Math.PI) / 180];
  return [metres * Math.cos(direction), metres * Math.sin(direction)];
}

function moved(from: Place, [north, east]: readonly [number, number]): Place {
  return destination(from, (Math.atan2(east, north) * 180) / Math.PI, Math.hypot(north, east));
}
