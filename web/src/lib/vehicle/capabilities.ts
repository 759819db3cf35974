/** Capabilities of a vehicle, which panels ask before they show themselves. */

import { MavProtocolCapability } from '$generated';

import type { VehicleState, VehicleType } from './Vehicle';

/** true: the vehicle has it; false: it has not; null: not known yet. */
export type Capability = boolean | null;

export interface Capabilities {
  readonly params: Capability;
  readonly mission: Capability;
  readonly fence: Capability;
  readonly rally: Capability;
  readonly logs: Capability;
  readonly shell: Capability;
  readonly takeoff: Capability;
  readonly goto: Capability;
  readonly orbit: Capability;
  /** It points at places. */
  readonly roi: Capability;
  /** Its home position can be set. */
  readonly home: Capability;
  readonly manualControl: Capability;
  readonly motorTest: Capability;
  /** Units fail on purpose, if a parameter permits it. */
  readonly failures: Capability;
  readonly terminate: Capability;
  readonly vtol: Capability;
  readonly ekfSources: Capability;
  readonly servos: Capability;
  readonly relays: Capability;
  readonly actuators: Capability;
  readonly gripper: Capability;
  readonly winch: Capability;
  /** A payload has extended parameters. */
  readonly extendedParameters: Capability;
  /** Its board has a bootloader, by which the firmware is replaced over USB. */
  readonly flashing: Capability;
  readonly osd: Capability;
  readonly vtx: Capability;
  /** The vehicle is reached by MSP, not MAVLink. */
  readonly msp: Capability;
  /** Kinds of calibration: `gyroscope`, `accelerometer`, `compass`, `level` … */
  readonly calibration: readonly string[];
  readonly cameras: readonly number[];
  readonly gimbals: readonly number[];
}

export const UNKNOWN_CAPABILITIES: Capabilities = {
  params: null,
  mission: null,
  fence: null,
  rally: null,
  logs: null,
  shell: null,
  takeoff: null,
  goto: null,
  orbit: null,
  roi: null,
  home: null,
  manualControl: null,
  motorTest: null,
  failures: null,
  terminate: null,
  vtol: null,
  ekfSources: null,
  servos: null,
  relays: null,
  actuators: null,
  gripper: null,
  winch: null,
  extendedParameters: null,
  flashing: null,
  osd: null,
  vtx: null,
  msp: null,
  calibration: [],
  cameras: [],
  gimbals: [],
};

const ALL_CALIBRATIONS = [
  'accelerometer',
  'gyroscope',
  'compass',
  'level',
  'airspeed',
  'barometer',
  'radio',
  'esc',
  'compass-motor',
] as const;
const GROUND_TYPES: ReadonlySet<VehicleType> = new Set(['rover', 'boat']);
/** Types that circle places with ArduPilot. */
const CIRCLING_TYPES: ReadonlySet<VehicleType> = new Set(['copter', 'helicopter', 'plane', 'vtol']);
const WINGED_TYPES: ReadonlySet<VehicleType> = new Set(['plane', 'vtol']);
const ESC_TYPES: ReadonlySet<VehicleType> = new Set(['copter', 'helicopter', 'vtol']);

/** Features by firmware that do not depend on the vehicle's own flags. */
const FIRMWARE: Readonly<Record<VehicleState['firmware'], Partial<Capabilities>>> = {
  ardupilot: {
    params: true,
    mission: true,
    logs: true,
    motorTest: true,
    failures: false,
    servos: true,
    relays: true,
    actuators: false,
    shell: false,
    manualControl: true,
    msp: false,
  },
  px4: {
    params: true,
    mission: true,
    logs: true,
    motorTest: true,
    failures: true,
    servos: false,
    relays: false,
    actuators: true,
    shell: true,
    manualControl: true,
    ekfSources: false,
    msp: false,
  },
  // Betaflight and iNav: their pilot flies them by radio control. iNav has missions, which its flags tell.
  msp: {
    params: true,
    fence: false,
    rally: false,
    logs: false,
    shell: false,
    takeoff: false,
    goto: false,
    orbit: false,
    roi: false,
    home: false,
    manualControl: false,
    motorTest: false,
    failures: false,
    terminate: false,
    vtol: false,
    ekfSources: false,
    servos: false,
    relays: false,
    actuators: false,
    gripper: false,
    winch: false,
    msp: true,
    calibration: ['accelerometer', 'compass'],
  },
  other: {},
};

/**
 * Returns the capabilities that follow from firmware, type and flags, for a vehicle without a server that tells them.
 *
 * @param flags - MAV_PROTOCOL_CAPABILITY of AUTOPILOT_VERSION, or null if it was not received.
 * @param equipment - What parameters of the vehicle told, such as `{ osd: true }`.
 */
export function capabilitiesFrom(
  firmware: VehicleState['firmware'],
  type: VehicleType,
  flags: bigint | null,
  equipment: Equipment = {},
): Capabilities {
  const flag = (bit: bigint): Capability => (flags === null ? null : (flags & bit) !== 0n);
  const isGround = GROUND_TYPES.has(type);
  const isKnown = firmware === 'ardupilot' || firmware === 'px4';
  return {
    ...UNKNOWN_CAPABILITIES,
    mission: flag(MavProtocolCapability.MISSION_INT),
    fence: flag(MavProtocolCapability.MISSION_FENCE),
    rally: flag(MavProtocolCapability.MISSION_RALLY),
    terminate: flag(MavProtocolCapability.FLIGHT_TERMINATION),
    takeoff: !isGround && type !== 'sub',
    goto: true,
    orbit: isKnown ? (firmware === 'px4' ? !isGround : CIRCLING_TYPES.has(type)) : null,
    roi: isKnown ? true : null,
    home: isKnown ? true : null,
    vtol: type === 'vtol',
    calibration: isKnown ? calibrationsOf(type) : [],
    ...FIRMWARE[firmware],
    ...equipment,
  };
}

export type Equipment = Readonly<Partial<Record<'osd' | 'vtx', boolean>>>;

/** Parameters by which a bridge of an MSP flight controller tells what the firmware has. */
export const EQUIPMENT_PARAMETERS: Readonly<Record<string, keyof Equipment>> = {
  MSP_HAS_OSD: 'osd',
  MSP_HAS_VTX: 'vtx',
};

/** Returns the equipment that a parameter tells of, or null. */
export function equipmentOf(parameter: string, value: number): Equipment | null {
  const name = EQUIPMENT_PARAMETERS[parameter];
  return name === undefined ? null : { [name]: value !== 0 };
}

function calibrationsOf(type: VehicleType): string[] {
  return ALL_CALIBRATIONS.filter((kind) => {
    if (kind === 'airspeed') return WINGED_TYPES.has(type);
    return kind === 'esc' || kind === 'compass-motor' ? ESC_TYPES.has(type) : true;
  });
}
