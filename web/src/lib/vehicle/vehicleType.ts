/** The kind of vehicle, its firmware and the names of its modes, from MAV_TYPE and MAV_AUTOPILOT. */

import { CopterMode, MavAutopilot, MavType, PlaneMode, RoverMode, SubMode } from '$generated';

import type { VehicleState, VehicleType } from './Vehicle';

const TYPES: Readonly<Record<number, VehicleType>> = {
  [MavType.FIXED_WING]: 'plane',
  [MavType.QUADROTOR]: 'copter',
  [MavType.COAXIAL]: 'helicopter',
  [MavType.HELICOPTER]: 'helicopter',
  [MavType.ANTENNA_TRACKER]: 'tracker',
  [MavType.AIRSHIP]: 'blimp',
  [MavType.FREE_BALLOON]: 'balloon',
  [MavType.ROCKET]: 'rocket',
  [MavType.GROUND_ROVER]: 'rover',
  [MavType.SURFACE_BOAT]: 'boat',
  [MavType.SUBMARINE]: 'sub',
  [MavType.HEXAROTOR]: 'copter',
  [MavType.OCTOROTOR]: 'copter',
  [MavType.TRICOPTER]: 'copter',
  [MavType.DODECAROTOR]: 'copter',
  [MavType.DECAROTOR]: 'copter',
  [MavType.GENERIC_MULTIROTOR]: 'copter',
  [MavType.GROUND_QUADRUPED]: 'rover',
};

/** Returns the kind of vehicle of a MAV_TYPE. */
export function vehicleTypeOf(mavType: number): VehicleType {
  if (mavType >= MavType.VTOL_TAILSITTER_DUOROTOR && mavType <= MavType.VTOL_RESERVED5) return 'vtol';
  return TYPES[mavType] ?? 'unknown';
}

/** Whether heartbeats of a component say that it is a vehicle's autopilot. */
export function isAutopilot(mavType: number, autopilot: number): boolean {
  return autopilot !== MavAutopilot.INVALID && mavType !== MavType.GCS;
}

/** Returns the firmware of a MAV_AUTOPILOT. */
export function firmwareOf(autopilot: number): VehicleState['firmware'] {
  if (autopilot === MavAutopilot.ARDUPILOTMEGA) return 'ardupilot';
  return autopilot === MavAutopilot.PX4 ? 'px4' : 'other';
}

const PX4_POSITION = 3;
const PX4_AUTO = 4;
const PX4_MAIN_MODES: readonly (string | undefined)[] = [
  undefined,
  'MANUAL',
  'ALTCTL',
  'POSCTL',
  'AUTO',
  'ACRO',
  'OFFBOARD',
  'STABILIZED',
  'RATTITUDE',
  'SIMPLE',
  'TERMINATION',
  'ALTITUDE_CRUISE',
];
const PX4_SUB_MODES: Readonly<Record<number, readonly (string | undefined)[]>> = {
  [PX4_POSITION]: [undefined, 'ORBIT', 'POSITION_SLOW'],
  [PX4_AUTO]: [
    undefined,
    'READY',
    'TAKEOFF',
    'LOITER',
    'MISSION',
    'RTL',
    'LAND',
    undefined,
    'FOLLOW_TARGET',
    'PRECLAND',
    'VTOL_TAKEOFF',
  ],
};

/** Returns the modes of ArduPilot for a kind of vehicle, by name. */
export function ardupilotModes(type: VehicleType): Readonly<Record<string, number>> {
  if (type === 'plane' || type === 'vtol') return PlaneMode;
  if (type === 'rover' || type === 'boat') return RoverMode;
  return type === 'sub' ? SubMode : CopterMode;
}

/** Returns the name of a mode from a heartbeat, or null. */
export function modeName(firmware: VehicleState['firmware'], type: VehicleType, customMode: number): string | null {
  if (firmware === 'ardupilot') {
    const modes = ardupilotModes(type);
    return Object.keys(modes).find((name) => modes[name] === customMode) ?? `MODE ${customMode}`;
  }
  if (firmware !== 'px4') return null;
  const [main, sub] = [(customMode >>> 16) & 0xff, customMode >>> 24];
  return PX4_SUB_MODES[main]?.[sub] ?? PX4_MAIN_MODES[main] ?? `MODE ${main}`;
}

/** Returns the modes of PX4 by name, as `custom_mode`. */
export function px4Modes(): Readonly<Record<string, number>> {
  const modes: Record<string, number> = {};
  PX4_MAIN_MODES.forEach((name, main) => {
    if (name !== undefined && main !== PX4_AUTO) modes[name] = main << 16;
  });
  for (const main of [PX4_POSITION, PX4_AUTO]) {
    PX4_SUB_MODES[main]?.forEach((name, sub) => {
      if (name !== undefined) modes[name] = ((sub << 24) | (main << 16)) >>> 0;
    });
  }
  return modes;
}
