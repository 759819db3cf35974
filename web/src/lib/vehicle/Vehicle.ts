/** The vehicle as views see it, whatever carries out its actions: the station's API or the protocol in the page. */

import type { Stream } from './streams';
import type { DecodedMessage } from '$lib/decoder/Decoder';

import type { ActionFields, ActionName } from '$lib/api/requests';

import type { Capabilities } from './capabilities';

export type VehicleType =
  | 'copter'
  | 'helicopter'
  | 'plane'
  | 'vtol'
  | 'rover'
  | 'boat'
  | 'sub'
  | 'blimp'
  | 'balloon'
  | 'rocket'
  | 'tracker'
  | 'unknown';

/** A place; altitudes are in m, null where the source does not tell them. */
export interface Position {
  readonly latitude: number;
  readonly longitude: number;
  /** Above mean sea level. */
  readonly altitude: number | null;
  /** Above home. */
  readonly relativeAltitude: number | null;
}

export interface Battery {
  readonly id: number;
  readonly voltage: number | null;
  readonly current: number | null;
  /** 0 … 1. */
  readonly remaining: number | null;
  readonly consumed: number | null;
  readonly cells: readonly number[];
  readonly temperature: number | null;
  /** MAV_BATTERY_CHARGE_STATE; null: not known. */
  readonly chargeState: number | null;
}

/** Trust of the vehicle in its own estimate of position and attitude. */
export interface Estimator {
  /** The largest test ratio of its sensors; 1 is the limit of the firmware. */
  readonly ratio: number;
  /** Word for what has that ratio: `velocity`, `position`, `height` or `compass`. */
  readonly worst: 'velocity' | 'position' | 'height' | 'compass';
  readonly isInitialized: boolean;
}

export interface Vibration {
  /** The largest of the three axes in m/s². */
  readonly level: number;
  /** Times that an accelerometer was at its limit. */
  readonly clipping: number;
}

export interface Gps {
  /** GPS_FIX_TYPE. */
  readonly fix: number;
  readonly satellites: number | null;
  readonly hdop: number | null;
  readonly horizontalAccuracy: number | null;
}

export interface StatusText {
  readonly system: number;
  readonly component: number;
  readonly time: number;
  /** MAV_SEVERITY: 0 is an emergency, 7 debug. */
  readonly severity: number;
  readonly text: string;
}

/** One of the senders that use one system id. */
export interface ConflictSender {
  /** Name by which it is chosen; null: it shares its channel with another one. */
  readonly channel: string | null;
  /** Such as `quadrotor with ArduPilot`. */
  readonly type: string;
  readonly uniqueId: string | null;
  readonly position: Target | null;
}

/** Two vehicles that use one system id: no action is possible before one of them is chosen. */
export interface Conflict {
  readonly text: string;
  readonly senders: readonly ConflictSender[];
  /** Channel of the sender that all packets come from and go to; null: none is chosen, every action is refused. */
  readonly chosen: string | null;
}

/** Latest values of a vehicle; null: not known. Degrees, metres, m/s, volts, amperes. A snapshot is never changed. */
export interface VehicleState {
  readonly system: number;
  readonly component: number;
  /** Heartbeats arrive. */
  readonly alive: boolean;
  /** Streams that ended while heartbeats arrive: their values are old. */
  readonly overdue: readonly Stream[];
  /** Time of the last message in ms since 1970. */
  readonly lastHeard: number;
  readonly type: VehicleType;
  /** MAV_TYPE. */
  readonly mavType: number;
  /** MAV_AUTOPILOT. */
  readonly autopilot: number;
  readonly firmware: 'ardupilot' | 'px4' | 'msp' | 'other';
  readonly armed: boolean | null;
  readonly mode: string | null;
  readonly customMode: number;
  /** MAV_STATE. */
  readonly systemStatus: number;
  readonly inAir: boolean | null;
  /** MAV_LANDED_STATE. */
  readonly landedState: number | null;
  /** MAV_VTOL_STATE. */
  readonly vtolState: number | null;
  /** Passes its checks before arming. */
  readonly ready: boolean | null;
  readonly position: Position | null;
  readonly home: Position | null;
  readonly roll: number | null;
  readonly pitch: number | null;
  /** 0 … 360. */
  readonly heading: number | null;
  readonly rollSpeed: number | null;
  readonly pitchSpeed: number | null;
  readonly yawSpeed: number | null;
  readonly groundSpeed: number | null;
  readonly airSpeed: number | null;
  readonly climbRate: number | null;
  readonly throttle: number | null;
  readonly velocity: { readonly north: number; readonly east: number; readonly down: number } | null;
  readonly battery: Battery | null;
  readonly batteries: readonly Battery[];
  readonly gps: Gps | null;
  readonly rc: { readonly channels: readonly (number | null)[]; readonly rssi: number | null } | null;
  /** Signal of the telemetry radio, 0 … 1. */
  readonly radio: { readonly local: number | null; readonly remote: number | null } | null;
  readonly estimator: Estimator | null;
  readonly vibration: Vibration | null;
  /** The vehicle is beyond its fence; null: not known, or it has none. */
  readonly fenceBreached: boolean | null;
  readonly wind: { readonly direction: number; readonly speed: number } | null;
  readonly mission: { readonly current: number; readonly total: number | null; readonly state: number | null } | null;
  /** Share of messages that were lost on the way, 0 … 1; null: not known yet. */
  readonly loss: number | null;
  /** Messages a second. */
  readonly rate: number;
  /** Last texts, the newest last. */
  readonly statusTexts: readonly StatusText[];
  /** Another vehicle uses the same system id; null: none was noticed. */
  readonly conflict: Conflict | null;
}

/** Returns whether every action on a vehicle is refused, since two vehicles would obey. */
export function isAmbiguous({ conflict }: Pick<VehicleState, 'conflict'>): boolean {
  return conflict !== null && conflict.chosen === null;
}

export interface Parameter {
  readonly name: string;
  readonly value: number;
  /** As people write it. */
  readonly text: string;
  /** MAV_PARAM_TYPE without its prefix, such as `REAL32`. */
  readonly type: string;
  /** False: a restart of the vehicle reverts it, until the parameters are saved. */
  readonly saved?: boolean;
}

export interface CommandResult {
  /** Name of MAV_RESULT, such as `ACCEPTED`. */
  readonly result: string;
  readonly detail: number;
  readonly attempts: number;
}

export type PlanKind = 'mission' | 'fence' | 'rally';

/** One item of a plan, as MISSION_ITEM_INT; `null` among the parameters is NaN. */
export interface PlanItem {
  readonly seq: number;
  readonly command: number;
  /** Name of MAV_CMD without its prefix. */
  readonly name: string;
  readonly frame: number;
  /** Seven parameters; latitude and longitude in degrees. */
  readonly params: readonly (number | null)[];
  readonly autocontinue: boolean;
}

export interface Plan {
  readonly items: readonly PlanItem[];
  readonly home: { readonly latitude: number; readonly longitude: number; readonly altitude: number } | null;
}

export interface Mode {
  readonly name: string;
  readonly number: number;
  readonly selectable: boolean;
  readonly advanced: boolean;
}

export interface Target {
  readonly latitude: number;
  readonly longitude: number;
}

export interface OrbitOptions {
  readonly center: Target;
  /** Above home; the present one if it is left out. */
  readonly altitude?: number;
  /** In m; negative turns counter-clockwise. */
  readonly radius?: number;
  readonly speed?: number;
}

/** Steps done and all steps; the total is null while it is not known. */
export type ProgressListener = (done: number, total: number | null) => void;
export type MessageListener = (message: DecodedMessage) => void;

/** Actions resolve when the vehicle has done them, and reject with a `StationError` that holds its reasons. */
export interface Vehicle {
  readonly system: number;
  readonly capabilities: Capabilities;
  /** Reactive in components: a new snapshot at most once per animation frame. */
  readonly state: VehicleState;

  getParameter(name: string): Promise<Parameter>;
  getParameters(onProgress?: ProgressListener): Promise<Parameter[]>;
  setParameter(name: string, value: number): Promise<Parameter>;

  /** Sends a command by its name without `MAV_CMD_` or its number; missing parameters are zero, null is NaN. */
  sendCommand(command: string | number, params?: readonly (number | null)[]): Promise<CommandResult>;
  /**
   * Arms; leaves a mode first in which the firmware does not arm, and refuses in one in which it would start by itself.
   */
  arm(force?: boolean): Promise<void>;
  disarm(force?: boolean): Promise<void>;
  takeoff(altitude: number): Promise<void>;
  land(): Promise<void>;
  rtl(): Promise<void>;
  hold(): Promise<void>;
  goto(target: Target, altitude?: number): Promise<void>;
  orbit(options: OrbitOptions): Promise<void>;
  /** Keeps pointing at a place at an altitude above home; null: points ahead again. */
  lookAt(target: Target | null, altitude?: number): Promise<void>;
  /** Moves the home position to a place; its altitude stays. */
  setHome(target: Target): Promise<void>;
  setSpeed(speed: number): Promise<void>;
  setAltitude(altitude: number): Promise<void>;
  setMode(name: string): Promise<void>;
  modes(): Promise<Mode[]>;
  /** Flies the mission, from its start or from where it was paused; `arm`: a disarmed vehicle is armed first. */
  startMission(arm?: boolean): Promise<void>;
  /** Stays at the present position; `startMission` resumes the mission. */
  pauseMission(): Promise<void>;
  /** Flies to an item next; items are counted from 1, as in the plan. */
  setMissionItem(number: number): Promise<void>;
  reboot(): Promise<void>;
  /** Carries out an action of the station's API by its name, such as `servo`; over USB, those of the equipment. */
  perform<Name extends ActionName>(action: Name, fields: ActionFields<Name>): Promise<void>;

  downloadPlan(kind: PlanKind, onProgress?: ProgressListener): Promise<Plan>;
  uploadPlan(kind: PlanKind, plan: Plan, onProgress?: ProgressListener): Promise<void>;
  clearPlan(kind: PlanKind): Promise<void>;

  /** Chooses which of two vehicles with this id is meant, by its channel; null: none. */
  chooseSender(channel: string | null): Promise<void>;
  /** Gives the vehicle of a channel a free system id; resolves to it. */
  renumber(channel: string | null): Promise<number>;

  /** Sends a message to the vehicle; `target_system` and `target_component` are filled in. */
  sendMessage(name: string, fields: Readonly<Record<string, number | bigint | string | readonly number[]>>): void;
  /** Registers a listener for messages of a name, or all (`*`); returns the function that removes it. */
  onMessage(name: string, listener: MessageListener): () => void;
  onState(listener: (state: VehicleState) => void): () => void;
  onStatusText(listener: (text: StatusText) => void): () => void;
}
