/** Telemetry of a vehicle of the demo: attitude and position ten times a second, the rest more slowly. */

import {
  MavLandedState,
  MavModeFlag,
  MavProtocolCapability,
  MavState,
  MavSysStatusSensor,
  MavVtolState,
} from '$generated';
import { messageInfo, type SentFields } from '$lib/decoder/Decoder';

import type { MockVehicle } from './MockVehicle';
import { toDegrees } from './place';

type Send = (name: string, fields: SentFields) => void;

const GUIDED_FLAGS = MavModeFlag.GUIDED_ENABLED | MavModeFlag.STABILIZE_ENABLED;
const SENSORS = 0x1230ffff;
const CAPABILITIES =
  MavProtocolCapability.PARAM_FLOAT |
  MavProtocolCapability.MISSION_INT |
  MavProtocolCapability.COMMAND_INT |
  MavProtocolCapability.SET_POSITION_TARGET_LOCAL_NED |
  MavProtocolCapability.SET_POSITION_TARGET_GLOBAL_INT |
  MavProtocolCapability.FLIGHT_TERMINATION |
  MavProtocolCapability.COMPASS_CALIBRATION |
  MavProtocolCapability.MAVLINK2 |
  MavProtocolCapability.MISSION_FENCE |
  MavProtocolCapability.MISSION_RALLY;
const STABLE_5_MODE = 1;
const WIND = { direction: 240, speed: 3.4 };
const NO_READING = 0xffff;

/** Interval in ms and message of each stream. */
type Stream = readonly [interval: number, name: string];

const STREAMS: readonly Stream[] = [
  [100, 'ATTITUDE'],
  [100, 'GLOBAL_POSITION_INT'],
  [200, 'VFR_HUD'],
  [500, 'RC_CHANNELS'],
  [500, 'SERVO_OUTPUT_RAW'],
  [1000, 'HEARTBEAT'],
  [1000, 'SYS_STATUS'],
  [1000, 'BATTERY_STATUS'],
  [1000, 'GPS_RAW_INT'],
  [1000, 'EXTENDED_SYS_STATE'],
  [1000, 'MISSION_CURRENT'],
  [1000, 'WIND'],
  [1000, 'VIBRATION'],
  [1000, 'SYSTEM_TIME'],
  [5000, 'HOME_POSITION'],
];
const REQUESTABLE: ReadonlyMap<number, string> = new Map(
  [
    'HEARTBEAT',
    'SYS_STATUS',
    'GPS_RAW_INT',
    'ATTITUDE',
    'GLOBAL_POSITION_INT',
    'VFR_HUD',
    'BATTERY_STATUS',
    'AUTOPILOT_VERSION',
    'HOME_POSITION',
    'EXTENDED_SYS_STATE',
    'CURRENT_MODE',
    'AVAILABLE_MODES',
  ].map((name) => [messageInfo(name)!.id, name]),
);

export class Telemetry {
  private readonly vehicle: MockVehicle;
  private readonly send: Send;
  private now = 0;
  private shown = '';

  constructor(vehicle: MockVehicle, send: Send) {
    this.vehicle = vehicle;
    this.send = send;
  }

  step(now: number): void {
    this.now = now;
    // Each vehicle sends at its own time, so that the work of a second is spread over it.
    const shift = (this.vehicle.profile.system * 100) % 1000;
    for (const [interval, name] of STREAMS) if ((now + shift) % interval === 0) this.emit(name);
    this.showChange();
    if (!this.vehicle.isArdupilot && (now + shift) % 2000 === 0) this.emitMspFacts();
    if (this.vehicle.profile.system === 1 && now % 1000 === 0) this.emitTraffic();
  }

  /** A change of mode or arming is told at once. */
  private showChange(): void {
    const { mode, armed } = this.vehicle.autopilot;
    const state = `${mode} ${armed}`;
    if (state !== this.shown) this.emit('HEARTBEAT');
    this.shown = state;
  }

  sendById(id: number): boolean {
    const name = REQUESTABLE.get(id);
    if (name !== undefined) this.emit(name);
    return name !== undefined;
  }

  private emit(name: string): void {
    const fields = this.fields(name);
    if (fields !== null) this.send(name, fields);
  }

  private fields(name: string): SentFields | null {
    const { motion } = this.vehicle.autopilot;
    switch (name) {
      case 'ATTITUDE':
        return {
          time_boot_ms: this.now,
          roll: motion.roll,
          pitch: motion.pitch,
          yaw: motion.yaw,
          yawspeed: motion.yawRate,
        };
      case 'GLOBAL_POSITION_INT':
        return this.position();
      case 'VFR_HUD':
        return this.hud();
      case 'HEARTBEAT':
        return this.heartbeat();
      case 'SYS_STATUS':
        return this.status();
      case 'BATTERY_STATUS':
        return this.battery();
      default:
        return this.other(name);
    }
  }

  private other(name: string): SentFields | null {
    const { autopilot, profile } = this.vehicle;
    switch (name) {
      case 'GPS_RAW_INT':
        return this.gps();
      case 'EXTENDED_SYS_STATE':
        return {
          landed_state: autopilot.landed ? MavLandedState.ON_GROUND : MavLandedState.IN_AIR,
          vtol_state: autopilot.type === 'vtol' ? MavVtolState.FW : 0,
        };
      case 'MISSION_CURRENT':
        return { seq: autopilot.current, total: Math.max(0, autopilot.mission.length - 1) };
      case 'HOME_POSITION':
        return this.home();
      case 'RC_CHANNELS':
        return this.channels();
      case 'SERVO_OUTPUT_RAW':
        return this.servos();
      case 'WIND':
        return { ...WIND, speed: WIND.speed + 0.6 * Math.sin(this.now / 4000 + profile.system) };
      case 'VIBRATION':
        return { vibration_x: this.noise(3), vibration_y: this.noise(3.3), vibration_z: this.noise(5) };
      case 'SYSTEM_TIME':
        return { time_unix_usec: Date.now() * 1000, time_boot_ms: this.now };
      case 'AUTOPILOT_VERSION':
        return this.version();
      case 'CURRENT_MODE':
        return { custom_mode: this.customMode };
      case 'AVAILABLE_MODES':
        return { number_modes: 1, mode_index: 1, custom_mode: this.customMode, mode_name: autopilot.mode };
      default:
        return null;
    }
  }

  private get customMode(): number {
    const { modes, mode } = this.vehicle.autopilot;
    return modes[mode] ?? STABLE_5_MODE;
  }

  private noise(size: number): number {
    return this.vehicle.autopilot.armed ? size * (1 + 0.3 * Math.sin(this.now / 700 + size)) : 0.02;
  }

  private heartbeat(): SentFields {
    const { profile, autopilot } = this.vehicle;
    return {
      type: profile.mavType,
      autopilot: profile.autopilot,
      base_mode: MavModeFlag.CUSTOM_MODE_ENABLED | GUIDED_FLAGS | (autopilot.armed ? MavModeFlag.SAFETY_ARMED : 0),
      custom_mode: this.customMode,
      system_status: autopilot.armed ? MavState.ACTIVE : MavState.STANDBY,
    };
  }

  private position(): SentFields {
    const { motion, home } = this.vehicle.autopilot;
    const { latitude, longitude, altitude } = toDegrees(motion);
    return {
      time_boot_ms: this.now,
      lat: Math.round(latitude * 1e7),
      lon: Math.round(longitude * 1e7),
      alt: Math.round(altitude * 1000),
      relative_alt: Math.round((motion.up - home.up) * 1000),
      vx: Math.round(motion.velocityNorth * 100),
      vy: Math.round(motion.velocityEast * 100),
      vz: Math.round(-motion.velocityUp * 100),
      hdg: Math.round(((motion.yaw * 180) / Math.PI + 360) * 100) % 36_000,
    };
  }

  private hud(): SentFields {
    const { motion, armed } = this.vehicle.autopilot;
    const isWing = motion.limits.kind === 'wing';
    return {
      airspeed: isWing ? Math.max(0, motion.groundSpeed - 1.5 * Math.cos(motion.yaw - 1)) : motion.groundSpeed,
      groundspeed: motion.groundSpeed,
      alt: toDegrees(motion).altitude,
      climb: motion.velocityUp,
      heading: Math.round(((motion.yaw * 180) / Math.PI + 360) % 360),
      throttle: armed ? Math.round(38 + motion.velocityUp * 8) : 0,
    };
  }

  private status(): SentFields {
    const { autopilot, profile } = this.vehicle;
    const health =
      profile.armingProblem === undefined
        ? SENSORS | MavSysStatusSensor.PREARM_CHECK
        : SENSORS & ~MavSysStatusSensor.PREARM_CHECK;
    return {
      onboard_control_sensors_present: (SENSORS | MavSysStatusSensor.PREARM_CHECK) >>> 0,
      onboard_control_sensors_enabled: (SENSORS | MavSysStatusSensor.PREARM_CHECK) >>> 0,
      onboard_control_sensors_health: health >>> 0,
      load: 210,
      voltage_battery: Math.round(this.voltage * 1000),
      current_battery: Math.round(autopilot.amperes * 100),
      battery_remaining: Math.round(autopilot.remaining * 100),
    };
  }

  private get voltage(): number {
    const { autopilot, profile } = this.vehicle;
    return profile.battery.voltage * (0.84 + 0.16 * autopilot.remaining) - autopilot.amperes * 0.02;
  }

  private battery(): SentFields {
    const { autopilot, profile } = this.vehicle;
    const cells = Math.round(profile.battery.voltage / 4.2);
    const cell = Math.round((this.voltage * 1000) / cells);
    return {
      voltages: Array.from({ length: 10 }, (_, index) => (index < cells ? cell + ((index * 7) % 5) : NO_READING)),
      current_battery: Math.round(autopilot.amperes * 100),
      current_consumed: Math.round((1 - autopilot.remaining) * profile.battery.capacity),
      battery_remaining: Math.round(autopilot.remaining * 100),
      temperature: 2900,
    };
  }

  private gps(): SentFields {
    const { motion } = this.vehicle.autopilot;
    const { latitude, longitude, altitude } = toDegrees(motion);
    const isUnderWater = motion.up < -0.5;
    return {
      time_usec: this.now * 1000,
      fix_type: isUnderWater ? 1 : 4,
      lat: Math.round(latitude * 1e7),
      lon: Math.round(longitude * 1e7),
      alt: Math.round(altitude * 1000),
      eph: isUnderWater ? NO_READING : 70,
      epv: 110,
      vel: Math.round(motion.groundSpeed * 100),
      satellites_visible: isUnderWater ? 0 : 14 + (this.vehicle.profile.system % 4),
      h_acc: 600,
      v_acc: 900,
    };
  }

  private home(): SentFields {
    const { latitude, longitude, altitude } = toDegrees(this.vehicle.autopilot.home);
    return {
      latitude: Math.round(latitude * 1e7),
      longitude: Math.round(longitude * 1e7),
      altitude: Math.round(altitude * 1000),
      q: [1, 0, 0, 0],
    };
  }

  /** All sticks of the transmitter are centred, so that a copter keeps its altitude in CIRCLE. */
  private channels(): SentFields {
    const fields: Record<string, number> = { time_boot_ms: this.now, chancount: 8, rssi: 220 };
    for (let channel = 1; channel <= 18; channel += 1) fields[`chan${channel}_raw`] = channel > 8 ? NO_READING : 1500;
    return fields;
  }

  private servos(): SentFields {
    const { motion, armed } = this.vehicle.autopilot;
    const throttle = armed ? 1450 + motion.velocityUp * 60 : 1000;
    const outputs = [1, -1, 1, -1].map((sign) => Math.round(throttle + (armed ? sign * motion.roll * 120 : 0)));
    return {
      time_usec: this.now * 1000,
      servo1_raw: outputs[0]!,
      servo2_raw: outputs[1]!,
      servo3_raw: outputs[2]!,
      servo4_raw: outputs[3]!,
    };
  }

  private version(): SentFields {
    const identifier = Array.from('BTFL\0\0\0\0', (letter) => letter.charCodeAt(0));
    return this.vehicle.isArdupilot
      ? { capabilities: CAPABILITIES, flight_sw_version: 0x04060000 + 255 }
      : {
          capabilities: MavProtocolCapability.MAVLINK2,
          flight_sw_version: 0x04050000 + 255,
          flight_custom_version: identifier,
        };
  }

  /** A bridge of an MSP flight controller sends the firmware and the name of the mode by itself. */
  private emitMspFacts(): void {
    for (const name of ['AUTOPILOT_VERSION', 'CURRENT_MODE', 'AVAILABLE_MODES']) this.emit(name);
  }

  /** An aircraft that passes by, as an ADS-B receiver sees it. */
  private emitTraffic(): void {
    const along = ((this.now / 1000) % 120) - 60;
    const { latitude, longitude } = toDegrees({ north: along * 45, east: 900 + along * 20, up: 0 });
    this.send('ADSB_VEHICLE', {
      ICAO_address: 0x4b1801,
      lat: Math.round(latitude * 1e7),
      lon: Math.round(longitude * 1e7),
      altitude: 1_150_000,
      heading: 2400,
      hor_velocity: 4900,
      flags: 0x1f,
      callsign: 'HBZUR',
      emitter_type: 1,
      tslc: 1,
      squawk: 7000,
    });
  }
}
