/**
 * Numbers of mission items: people count from 1, as the plan view does. ArduPilot counts its home as item 0, so that
 * its sequence numbers are those of people; other vehicles count from 0.
 */

import type { VehicleState } from './Vehicle';

/** Returns the number of the current mission item, from 1; null: none, or not known. */
export function currentItemNumber({ mission, firmware }: Pick<VehicleState, 'mission' | 'firmware'>): number | null {
  if (mission === null) return null;
  const number = firmware === 'ardupilot' ? mission.current : mission.current + 1;
  return number >= 1 && number <= (mission.total ?? Infinity) ? number : null;
}

/** Returns the sequence number by which a vehicle knows the item with a number. */
export function sequenceOf(number: number, firmware: VehicleState['firmware']): number {
  return firmware === 'ardupilot' ? number : number - 1;
}
