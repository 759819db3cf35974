/** The fields of each message → the draft of a vehicle's state. */

import { EkfStatusFlags, MavModeFlag, MavSysStatusSensor } from '$generated';
import type { DecodedMessage, FieldValue } from '$lib/decoder/Decoder';

import { radioOf, withPort } from './radio';
import type { Battery, Estimator, VehicleState } from './Vehicle';
import { firmwareOf, vehicleTypeOf } from './vehicleType';

export type Draft = { -readonly [Key in keyof VehicleState]: VehicleState[Key] } & {
  /** When RC_CHANNELS arrived. */
  rcTime: number;
};
type Fields = DecodedMessage['fields'];
type Reader = (draft: Draft, fields: Fields, message: DecodedMessage) => void;

const DEGREES = 180 / Math.PI;
const NO_U16 = 0xffff;
const NO_U8 = 0xff;
const NO_I16 = 0x7fff;
const UPPER_HALF = 0x10000;
/** RC_CHANNELS_RAW counts if RC_CHANNELS is older than this, in ms. */
const FINE_LIFETIME = 10_000;

export const number = (value: FieldValue | undefined): number => Number(value ?? 0);

/** Returns a scaled value, or null if it is NaN or the mark of an unknown value. */
function known(value: FieldValue | undefined, unknown: number | null = null, scale = 1): number | null {
  const plain = Number(value);
  return Number.isFinite(plain) && plain !== unknown ? plain * scale : null;
}

/** Returns the place of HIGH_LATENCY2, whose altitude is in whole metres above the sea; null: not known. */
function coarsePosition(fields: Fields): VehicleState['position'] {
  const [latitude, longitude] = [number(fields.latitude) / 1e7, number(fields.longitude) / 1e7];
  if (latitude === 0 && longitude === 0) return null;
  return { latitude, longitude, altitude: number(fields.altitude), relativeAltitude: null };
}

const EMPTY_BATTERY: Battery = {
  id: 0,
  voltage: null,
  current: null,
  remaining: null,
  consumed: null,
  cells: [],
  temperature: null,
  chargeState: null,
};

function batteryOf(fields: Fields): Battery {
  const all = [
    ...((fields.voltages as readonly number[]) ?? []),
    ...((fields.voltages_ext as readonly number[]) ?? []),
  ];
  const cells = all.filter((cell) => cell !== NO_U16 && cell > 0).map((cell) => cell / 1000);
  const temperature = known(fields.temperature, NO_I16, 0.01);
  return {
    id: number(fields.id),
    voltage: cells.length > 0 ? cells.reduce((sum, cell) => sum + cell, 0) : null,
    current: known(fields.current_battery, -1, 0.01),
    remaining: known(fields.battery_remaining, -1, 0.01),
    consumed: known(fields.current_consumed, -1),
    cells: cells.length > 1 ? cells : [],
    temperature,
    chargeState: number(fields.charge_state) || null,
  };
}

/** ArduPilot trusts its estimate up to this variance unless FS_EKF_THRESH says otherwise; PX4 up to a ratio of 1. */
const MAX_VARIANCE = 0.8;

function estimatorOf(
  fields: Fields,
  names: Readonly<Record<Estimator['worst'], string>>,
  limit: number,
  isInitialized: boolean,
): Estimator {
  const ratios = Object.entries(names).map(([worst, name]) => {
    return { worst: worst as Estimator['worst'], ratio: (known(fields[name]) ?? 0) / limit };
  });
  return { ...ratios.reduce((one, other) => (other.ratio > one.ratio ? other : one)), isInitialized };
}

/** Readers by the name of their message. */
export const READERS: Readonly<Record<string, Reader>> = {
  HEARTBEAT(draft, fields) {
    draft.mavType = number(fields.type);
    draft.type = vehicleTypeOf(draft.mavType);
    draft.autopilot = number(fields.autopilot);
    if (draft.firmware !== 'msp') draft.firmware = firmwareOf(draft.autopilot);
    draft.customMode = number(fields.custom_mode);
    draft.armed = (number(fields.base_mode) & MavModeFlag.SAFETY_ARMED) !== 0;
    draft.systemStatus = number(fields.system_status);
  },
  HIGH_LATENCY2(draft, fields) {
    draft.mavType = number(fields.type);
    draft.type = vehicleTypeOf(draft.mavType);
    draft.autopilot = number(fields.autopilot);
    draft.firmware = firmwareOf(draft.autopilot);
    const isPx4 = draft.firmware === 'px4';
    // It has 16 bits for the mode: PX4 sends the upper half of its number, which has the mode.
    draft.customMode = number(fields.custom_mode) * (isPx4 ? UPPER_HALF : 1);
    // ArduPilot sends the base mode of HEARTBEAT beside it.
    draft.armed = isPx4 ? null : (number(fields.custom0) & MavModeFlag.SAFETY_ARMED) !== 0;
    draft.position = coarsePosition(fields) ?? draft.position;
    draft.heading = (number(fields.heading) * 2) % 360;
    draft.airSpeed = number(fields.airspeed) / 5;
    draft.groundSpeed = number(fields.groundspeed) / 5;
    draft.climbRate = number(fields.climb_rate) / 10;
    draft.throttle = number(fields.throttle) / 100;
    const remaining = known(fields.battery, -1, 0.01);
    draft.battery = remaining === null ? draft.battery : { ...EMPTY_BATTERY, remaining };
    draft.mission = { current: number(fields.wp_num), total: null, state: null };
  },
  ATTITUDE(draft, fields) {
    draft.roll = number(fields.roll) * DEGREES;
    draft.pitch = number(fields.pitch) * DEGREES;
    draft.heading = (number(fields.yaw) * DEGREES + 360) % 360;
    draft.rollSpeed = number(fields.rollspeed) * DEGREES;
    draft.pitchSpeed = number(fields.pitchspeed) * DEGREES;
    draft.yawSpeed = number(fields.yawspeed) * DEGREES;
  },
  GLOBAL_POSITION_INT(draft, fields) {
    const [latitude, longitude] = [number(fields.lat) / 1e7, number(fields.lon) / 1e7];
    if (latitude === 0 && longitude === 0) return;
    draft.position = {
      latitude,
      longitude,
      altitude: number(fields.alt) / 1000,
      relativeAltitude: number(fields.relative_alt) / 1000,
    };
    const [north, east] = [number(fields.vx) / 100, number(fields.vy) / 100];
    draft.velocity = { north, east, down: number(fields.vz) / 100 };
    draft.groundSpeed = Math.hypot(north, east);
    draft.climbRate = -number(fields.vz) / 100;
  },
  VFR_HUD(draft, fields) {
    draft.airSpeed = known(fields.airspeed);
    draft.groundSpeed = known(fields.groundspeed);
    draft.climbRate = known(fields.climb);
    draft.throttle = number(fields.throttle) / 100;
    draft.heading ??= number(fields.heading);
  },
  GPS_RAW_INT(draft, fields) {
    draft.gps = {
      fix: number(fields.fix_type),
      satellites: known(fields.satellites_visible, NO_U8),
      hdop: known(fields.eph, NO_U16, 0.01),
      horizontalAccuracy: number(fields.h_acc) > 0 ? number(fields.h_acc) / 1000 : null,
    };
  },
  SYS_STATUS(draft, fields) {
    if (draft.batteries.length === 0) {
      draft.battery = {
        ...EMPTY_BATTERY,
        voltage: known(fields.voltage_battery, NO_U16, 0.001),
        current: known(fields.current_battery, -1, 0.01),
        remaining: known(fields.battery_remaining, -1, 0.01),
      };
    }
    const present = number(fields.onboard_control_sensors_present);
    const health = number(fields.onboard_control_sensors_health);
    // PX4 never marks the check as present, but sets its health bit.
    if (draft.firmware === 'px4' || (present & MavSysStatusSensor.PREARM_CHECK) !== 0)
      draft.ready = (health & MavSysStatusSensor.PREARM_CHECK) !== 0;
  },
  BATTERY_STATUS(draft, fields) {
    const battery = batteryOf(fields);
    draft.batteries = [...draft.batteries.filter((each) => each.id !== battery.id), battery].sort(
      (a, b) => a.id - b.id,
    );
    draft.battery = draft.batteries[0]!;
  },
  EXTENDED_SYS_STATE(draft, fields) {
    draft.landedState = number(fields.landed_state) || null;
    draft.vtolState = number(fields.vtol_state) || null;
  },
  HOME_POSITION(draft, fields) {
    const [latitude, longitude] = [number(fields.latitude) / 1e7, number(fields.longitude) / 1e7];
    draft.home = { latitude, longitude, altitude: number(fields.altitude) / 1000, relativeAltitude: 0 };
  },
  RC_CHANNELS(draft, fields, { time }) {
    draft.rc = radioOf(fields);
    draft.rcTime = time;
  },
  RC_CHANNELS_RAW(draft, fields, { time }) {
    // RC_CHANNELS has all channels in one message.
    if (Math.abs(time - draft.rcTime) >= FINE_LIFETIME) draft.rc = withPort(draft.rc, fields);
  },
  RADIO_STATUS(draft, fields) {
    draft.radio = { local: known(fields.rssi, NO_U8, 1 / 254), remote: known(fields.remrssi, NO_U8, 1 / 254) };
  },
  WIND(draft, fields) {
    draft.wind = { direction: (number(fields.direction) + 360) % 360, speed: number(fields.speed) };
  },
  WIND_COV(draft, fields) {
    const [north, east] = [number(fields.wind_x), number(fields.wind_y)];
    draft.wind = { direction: (Math.atan2(-east, -north) * DEGREES + 360) % 360, speed: Math.hypot(north, east) };
  },
  EKF_STATUS_REPORT(draft, fields) {
    const names = {
      velocity: 'velocity_variance',
      position: 'pos_horiz_variance',
      height: 'pos_vert_variance',
      compass: 'compass_variance',
    };
    draft.estimator = estimatorOf(
      fields,
      names,
      MAX_VARIANCE,
      (number(fields.flags) & EkfStatusFlags.UNINITIALIZED) === 0,
    );
  },
  ESTIMATOR_STATUS(draft, fields) {
    const names = {
      velocity: 'vel_ratio',
      position: 'pos_horiz_ratio',
      height: 'pos_vert_ratio',
      compass: 'mag_ratio',
    };
    draft.estimator = estimatorOf(fields, names, 1, true);
  },
  VIBRATION(draft, fields) {
    const levels = [fields.vibration_x, fields.vibration_y, fields.vibration_z].map((level) => known(level) ?? 0);
    const clips = [fields.clipping_0, fields.clipping_1, fields.clipping_2].map(number);
    draft.vibration = { level: Math.max(...levels), clipping: clips.reduce((sum, count) => sum + count, 0) };
  },
  FENCE_STATUS(draft, fields) {
    draft.fenceBreached = number(fields.breach_status) !== 0;
  },
  MISSION_CURRENT(draft, fields) {
    draft.mission = {
      current: number(fields.seq),
      total: number(fields.total) > 0 ? known(fields.total, NO_U16) : null,
      state: number(fields.mission_state) || null,
    };
  },
  AUTOPILOT_VERSION(draft, fields) {
    const identifier = identifierOf(fields.flight_custom_version as Uint8Array | undefined);
    if (MSP_IDENTIFIERS.has(identifier)) draft.firmware = 'msp';
  },
  CURRENT_MODE(draft, fields) {
    if (draft.firmware === 'msp') draft.customMode = number(fields.custom_mode);
  },
};

const MSP_IDENTIFIERS: ReadonlySet<string> = new Set(['BTFL', 'INAV']);

/** A bridge of an MSP flight controller puts the firmware's identifier into its version. */
function identifierOf(bytes: Uint8Array | undefined): string {
  return bytes === undefined ? '' : String.fromCharCode(...bytes.subarray(0, 4));
}

/** Returns the state of a vehicle of which only a heartbeat was received. */
export function emptyState(heartbeat: DecodedMessage): Draft {
  const { system, component, time } = heartbeat;
  return {
    system,
    component,
    alive: true,
    overdue: [],
    lastHeard: time,
    type: 'unknown',
    mavType: 0,
    autopilot: 0,
    firmware: 'other',
    armed: null,
    mode: null,
    customMode: 0,
    systemStatus: 0,
    inAir: null,
    landedState: null,
    vtolState: null,
    ready: null,
    position: null,
    home: null,
    roll: null,
    pitch: null,
    heading: null,
    rollSpeed: null,
    pitchSpeed: null,
    yawSpeed: null,
    groundSpeed: null,
    airSpeed: null,
    climbRate: null,
    throttle: null,
    velocity: null,
    battery: null,
    batteries: [],
    gps: null,
    rc: null,
    rcTime: 0,
    radio: null,
    wind: null,
    estimator: null,
    vibration: null,
    fenceBreached: null,
    mission: null,
    loss: null,
    rate: 0,
    statusTexts: [],
    conflict: null,
  };
}
