/** Modes for the actions that firmwares and vehicle types name differently, as `mavstack.vehicle` chooses them. */

import type { VehicleState, VehicleType } from '../Vehicle';

/** Modes of ArduPilot that stay in place; those that need no throttle stick: a copter in LOITER sinks without one. */
const ARDUPILOT_HOLD: Readonly<Partial<Record<VehicleType, string>>> = {
  copter: 'BRAKE', helicopter: 'BRAKE', plane: 'LOITER', vtol: 'LOITER', rover: 'HOLD', boat: 'LOITER', sub: 'POSHOLD',
};
const ARDUPILOT_LAND: Readonly<Partial<Record<VehicleType, string>>> = { vtol: 'QLAND', sub: 'SURFACE' };

export const RETURN_MODES = ['RTL', 'SURFACE'];
export const MISSION_MODES = ['AUTO', 'MISSION'];

/** Modes that no user enters. */
export const NOT_SELECTABLE: ReadonlySet<string> = new Set([
  'INITIALISING', 'INITIALIZING', 'READY', 'RATTITUDE', 'SIMPLE', 'TERMINATION',
]);

/** Returns the mode in which a vehicle stays where it is. */
export function holdMode(firmware: VehicleState['firmware'], type: VehicleType): string {
  return (firmware === 'ardupilot' ? ARDUPILOT_HOLD[type] : undefined) ?? 'LOITER';
}

/** Returns the mode in which a vehicle lands here. */
export function landMode(firmware: VehicleState['firmware'], type: VehicleType): string {
  return (firmware === 'ardupilot' ? ARDUPILOT_LAND[type] : undefined) ?? 'LAND';
}
