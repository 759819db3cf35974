/** Messages of one vehicle → its state. A message changes a draft; `snapshot` gives the views a copy of it. */

import type { DecodedMessage, FieldValue } from '$lib/decoder/Decoder';

import { isInAir } from './inAir';
import { radioOf, withPort } from './radio';
import type { Battery, Conflict, Estimator, StatusText, VehicleState } from './Vehicle';
import { firmwareOf, modeName, vehicleTypeOf } from './vehicleType';

type Draft = { -readonly [Key in keyof VehicleState]: VehicleState[Key] } & {
  /** When RC_CHANNELS arrived. */
  rcTime: number;
};
type Fields = DecodedMessage['fields'];
type Reader = (draft: Draft, fields: Fields, message: DecodedMessage) => void;

const DEGREES = 180 / Math.PI;
const ARMED = 128;
const NO_U16 = 0xffff;
const NO_U8 = 0xff;
const NO_I16 = 0x7fff;
const PREARM_CHECK = 0x10000000;
const MAX_STATUS_TEXTS = 200;
/** Status texts whose last part is still missing; that of an older one was lost. */
const MAX_OPEN_TEXTS = 16;
/** RC_CHANNELS_RAW counts if RC_CHANNELS is older than this, in ms. */
const FINE_LIFETIME = 10_000;
/** Time in ms after which the share of lost packets is known. */
const LOSS_TIME = 5000;
/** A text in ms that the station received so much earlier or later than the page is another one. */
const SAME_TEXT_TIME = 3000;
/** Heartbeats come once a second. */
const ALIVE_TIMEOUT = 5000;

const number = (value: FieldValue | undefined): number => Number(value ?? 0);

/** Returns a scaled value, or null if it is NaN or the mark of an unknown value. */
function known(value: FieldValue | undefined, unknown: number | null = null, scale = 1): number | null {
  const plain = Number(value);
  return Number.isFinite(plain) && plain !== unknown ? plain * scale : null;
}

export class StateTracker {
  private readonly draft: Draft;
  private readonly sequences = new Map<number, number>();
  private received = 0;
  private lost = 0;
  private windowStart = 0;
  private countedSince: number | null = null;
  private windowCount = 0;
  private readonly textParts = new Map<string, string[]>();
  /** Names of modes that the vehicle told, by number. */
  private readonly modeNames = new Map<number, string>();

  constructor(heartbeat: DecodedMessage) {
    this.draft = emptyState(heartbeat);
    this.take(heartbeat);
  }

  /** Takes a message of the vehicle; returns a completed status text, or null. */
  take(message: DecodedMessage): StatusText | null {
    this.count(message);
    if (message.name === 'STATUSTEXT') return this.takeText(message);
    // Cameras and gimbals have the system id of the vehicle, and heartbeats of their own.
    if (message.component === this.draft.component || !OWN_MESSAGES.has(message.name)) {
      READERS[message.name]?.(this.draft, message.fields, message);
      if (MODE_MESSAGES.has(message.name)) this.nameMode(message);
    }
    return null;
  }

  /** Takes a home that the vehicle told before the page listened; its own messages win. */
  learnHome(latitude: number, longitude: number, altitude: number): void {
    this.draft.home ??= { latitude, longitude, altitude, relativeAltitude: 0 };
  }

  setConflict(conflict: Conflict | null): void {
    this.draft.conflict = conflict;
  }

  /** Takes texts that the vehicle sent before the page listened; returns those that are new. */
  learnTexts(texts: readonly StatusText[]): StatusText[] {
    const known = [...this.draft.statusTexts];
    const added = texts.filter((text) => {
      const at = known.findIndex((each) => isSameText(each, text));
      if (at >= 0) known.splice(at, 1);
      return at < 0;
    });
    if (added.length === 0) return [];
    const all = [...this.draft.statusTexts, ...added].sort((one, other) => one.time - other.time);
    this.draft.statusTexts = all.slice(-MAX_STATUS_TEXTS);
    return added;
  }

  private nameMode({ name, fields }: DecodedMessage): void {
    const { draft, modeNames } = this;
    if (name === 'AVAILABLE_MODES' && modeNames.size < MAX_MODES) modeNames.set(number(fields.custom_mode), String(fields.mode_name));
    draft.mode = modeName(draft.firmware, draft.type, draft.customMode) ?? modeNames.get(draft.customMode) ?? null;
  }

  /** Returns a copy of the state at a time in ms since 1970. */
  snapshot(now: number): VehicleState {
    this.draft.alive = now - this.heartbeatTime < ALIVE_TIMEOUT;
    this.draft.inAir = isInAir(this.draft, now - this.landedTime);
    return { ...this.draft };
  }

  private heartbeatTime = 0;
  private landedTime = 0;

  private count(message: DecodedMessage): void {
    const { component, sequence, time } = message;
    const last = this.sequences.get(component);
    this.sequences.set(component, sequence);
    const missing = last === undefined ? 0 : (sequence - last - 1) & 0xff;
    // A large gap is a restart or another path, not a loss.
    if (missing < 128) this.lost += missing;
    this.received += 1;
    this.windowCount += 1;
    this.draft.lastHeard = time;
    if (component === this.draft.component) {
      if (message.name === 'HEARTBEAT') this.heartbeatTime = time;
      if (message.name === 'EXTENDED_SYS_STATE') this.landedTime = time;
    }
    if (this.countedSince === null || time < this.countedSince) this.countedSince = time;
    const elapsed = time - this.windowStart;
    // A replay may go back.
    if (elapsed >= 0 && elapsed < 1000) return;
    if (this.windowStart > 0 && elapsed > 0) this.draft.rate = (this.windowCount * 1000) / elapsed;
    // The first seconds of a link are no measure: packets of before the page listened arrive among the new ones.
    if (time - this.countedSince >= LOSS_TIME) this.draft.loss = this.lost / (this.lost + this.received);
    this.windowStart = time;
    this.windowCount = 0;
    // Older losses count half each second.
    this.lost /= 2;
    this.received /= 2;
  }

  private takeText(message: DecodedMessage): StatusText | null {
    const { fields, system, component, time } = message;
    const [id, part, piece] = [number(fields.id), number(fields.chunk_seq), String(fields.text)];
    let text = piece;
    if (id !== 0) {
      const key = `${component}/${id}`;
      const parts = this.textParts.get(key) ?? [];
      parts[part] = piece;
      if (piece.length === 50) {
        this.textParts.set(key, parts);
        if (this.textParts.size > MAX_OPEN_TEXTS) this.textParts.delete(this.textParts.keys().next().value!);
        return null;
      }
      this.textParts.delete(key);
      text = Array.from(parts, (each) => each ?? '…').join('');
    }
    const status: StatusText = { system, component, time, severity: number(fields.severity), text };
    this.draft.statusTexts = [...this.draft.statusTexts, status].slice(-MAX_STATUS_TEXTS);
    return status;
  }
}

/** Whether two records are of one text: the station and the page received it at slightly different times. */
function isSameText(one: StatusText, other: StatusText): boolean {
  const isClose = Math.abs(one.time - other.time) < SAME_TEXT_TIME;
  return isClose && one.text === other.text && one.component === other.component && one.severity === other.severity;
}

/** Messages that other components of the system send about themselves. */
const OWN_MESSAGES: ReadonlySet<string> = new Set([
  'HEARTBEAT', 'SYS_STATUS', 'ATTITUDE', 'GLOBAL_POSITION_INT', 'GPS_RAW_INT', 'VFR_HUD', 'EXTENDED_SYS_STATE',
  'BATTERY_STATUS', 'HOME_POSITION', 'EKF_STATUS_REPORT', 'ESTIMATOR_STATUS', 'VIBRATION', 'FENCE_STATUS', 'RC_CHANNELS', 'RC_CHANNELS_RAW', 'CURRENT_MODE', 'AVAILABLE_MODES',
]);

/** Messages that tell the mode, or the name of one. */
const MODE_MESSAGES: ReadonlySet<string> = new Set(['HEARTBEAT', 'CURRENT_MODE', 'AVAILABLE_MODES', 'AUTOPILOT_VERSION']);
const MAX_MODES = 256;

function batteryOf(fields: Fields): Battery {
  const all = [...((fields.voltages as readonly number[]) ?? []), ...((fields.voltages_ext as readonly number[]) ?? [])];
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

const UNINITIALIZED = 1 << 10;
/** ArduPilot trusts its estimate up to this variance unless FS_EKF_THRESH says otherwise; PX4 up to a ratio of 1. */
const MAX_VARIANCE = 0.8;

function estimatorOf(
  fields: Fields, names: Readonly<Record<Estimator['worst'], string>>, limit: number, isInitialized: boolean,
): Estimator {
  const ratios = Object.entries(names).map(([worst, name]) => {
    return { worst: worst as Estimator['worst'], ratio: (known(fields[name]) ?? 0) / limit };
  });
  return { ...ratios.reduce((one, other) => (other.ratio > one.ratio ? other : one)), isInitialized };
}

const READERS: Readonly<Record<string, Reader>> = {
  HEARTBEAT(draft, fields) {
    draft.mavType = number(fields.type);
    draft.type = vehicleTypeOf(draft.mavType);
    draft.autopilot = number(fields.autopilot);
    if (draft.firmware !== 'msp') draft.firmware = firmwareOf(draft.autopilot);
    draft.customMode = number(fields.custom_mode);
    draft.armed = (number(fields.base_mode) & ARMED) !== 0;
    draft.systemStatus = number(fields.system_status);
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
        id: 0,
        voltage: known(fields.voltage_battery, NO_U16, 0.001),
        current: known(fields.current_battery, -1, 0.01),
        remaining: known(fields.battery_remaining, -1, 0.01),
        consumed: null,
        cells: [],
        temperature: null,
        chargeState: null,
      };
    }
    const present = number(fields.onboard_control_sensors_present);
    const health = number(fields.onboard_control_sensors_health);
    // PX4 never marks the check as present, but sets its health bit.
    if (draft.firmware === 'px4' || (present & PREARM_CHECK) !== 0) draft.ready = (health & PREARM_CHECK) !== 0;
  },
  BATTERY_STATUS(draft, fields) {
    const battery = batteryOf(fields);
    draft.batteries = [...draft.batteries.filter((each) => each.id !== battery.id), battery].sort((a, b) => a.id - b.id);
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
    const names = { velocity: 'velocity_variance', position: 'pos_horiz_variance', height: 'pos_vert_variance', compass: 'compass_variance' };
    draft.estimator = estimatorOf(fields, names, MAX_VARIANCE, (number(fields.flags) & UNINITIALIZED) === 0);
  },
  ESTIMATOR_STATUS(draft, fields) {
    const names = { velocity: 'vel_ratio', position: 'pos_horiz_ratio', height: 'pos_vert_ratio', compass: 'mag_ratio' };
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

function emptyState(heartbeat: DecodedMessage): Draft {
  const { system, component, time } = heartbeat;
  return {
    system,
    component,
    alive: true,
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
