/** The places of a formation on the map, and the vehicle that is nearest to each. */
import { bearing, destination, distance, type Place } from '$lib/map/geometry';

/** Metres forward, right and up of the leader. */
export type Slot = readonly [number, number, number];

/** Returns the place of a slot, of a leader that heads in a direction. */
export function placeOf([forward, right]: Slot, leader: Place, course: number): Place {
  const metres = Math.hypot(forward, right);
  if (metres === 0) return leader;
  return destination(leader, course + (Math.atan2(right, forward) * 180) / Math.PI, metres);
}

/** Returns metres north and east of one place to another. */
export function offsetOf(from: Place, to: Place): { readonly north: number; readonly east: number } {
  const angle = (bearing(from, to) * Math.PI) / 180;
  const metres = distance(from, to);
  return { north: Math.cos(angle) * metres, east: Math.sin(angle) * metres };
}

/** Returns whether a text is a number above zero; an empty one means null. */
export function positiveOrNull(value: number | null | undefined): number | null {
  return value !== null && value !== undefined && Number.isFinite(value) && value > 0 ? value : null;
}
