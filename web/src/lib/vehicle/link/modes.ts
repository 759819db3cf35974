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

type ByType = Readonly<Partial<Record<VehicleType, readonly string[]>>>;

/** Modes in which a firmware does not arm: a copter stays in RTL, LAND or AUTO after it has landed there. */
const NO_ARMING: Readonly<Partial<Record<VehicleState['firmware'], ByType | readonly string[]>>> = {
  ardupilot: {
    copter: ['AUTO', 'AUTO_RTL', 'RTL', 'SMART_RTL', 'LAND', 'BRAKE', 'CIRCLE', 'FLIP', 'AUTOTUNE', 'FOLLOW'],
    helicopter: ['AUTO', 'AUTO_RTL', 'RTL', 'SMART_RTL', 'LAND', 'BRAKE', 'CIRCLE', 'FLIP', 'AUTOTUNE', 'FOLLOW'],
    plane: ['RTL', 'QRTL', 'QLAND', 'INITIALIZING'],
    vtol: ['RTL', 'QRTL', 'QLAND', 'INITIALIZING'],
    rover: ['RTL', 'SMART_RTL', 'INITIALIZING'],
    boat: ['RTL', 'SMART_RTL', 'INITIALIZING'],
  },
  px4: ['RTL', 'LAND', 'PRECLAND', 'DESCEND', 'ORBIT', 'TERMINATION'],
};
const WINGS = ['TAKEOFF', 'AUTO', 'AUTOLAND', 'CIRCLE', 'AVOID_ADSB', 'THERMAL'];
const SURFACE = ['AUTO', 'CIRCLE', 'FOLLOW', 'DOCK'];
/** Modes in which a vehicle starts to fly or to drive as soon as it is armed. */
const SELF_STARTING: typeof NO_ARMING = {
  ardupilot: {
    copter: ['AUTO', 'THROW'], helicopter: ['AUTO', 'THROW'], plane: [...WINGS, 'GUIDED', 'LOITER'], vtol: WINGS,
    rover: SURFACE, boat: SURFACE, sub: ['AUTO', 'CIRCLE'],
  },
  px4: ['TAKEOFF', 'VTOL_TAKEOFF', 'MISSION', 'OFFBOARD', 'FOLLOW_TARGET'],
};
/** Modes in which a vehicle of ArduPilot waits on the ground once it is armed. */
const ARDUPILOT_WAITING: Readonly<Partial<Record<VehicleType, string>>> = {
  copter: 'GUIDED', helicopter: 'GUIDED', plane: 'FLY_BY_WIRE_A', vtol: 'GUIDED', rover: 'HOLD', boat: 'HOLD', sub: 'POSHOLD',
};

type Moded = Pick<VehicleState, 'firmware' | 'type' | 'mode'>;

function isIn(table: typeof NO_ARMING, { firmware, type, mode }: Moded): boolean {
  const modes = table[firmware];
  const names = Array.isArray(modes) ? (modes as readonly string[]) : (modes as ByType | undefined)?.[type];
  return mode !== null && (names?.includes(mode) ?? false);
}

/** Returns whether the firmware arms in the present mode; true if that is not known. */
export function allowsArming(state: Moded): boolean {
  return !isIn(NO_ARMING, state);
}

/** Returns whether a vehicle that is armed in its mode starts to fly or to drive without a command. */
export function startsByItself(state: Moded): boolean {
  return isIn(SELF_STARTING, state);
}

/** Returns the mode in which a vehicle waits on the ground once it is armed, or null. */
export function waitingMode({ firmware, type }: Pick<VehicleState, 'firmware' | 'type'>): string | null {
  if (firmware === 'px4') return 'LOITER';
  return firmware === 'ardupilot' ? (ARDUPILOT_WAITING[type] ?? null) : null;
}
