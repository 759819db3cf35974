/** Messages of one vehicle → its state. A message changes a draft; `snapshot` gives the views a copy of it. */

import type { DecodedMessage } from '$lib/decoder/Decoder';

import { isInAir } from './inAir';
import { type Draft, emptyState, number, READERS } from './stateReaders';
import { StreamWatch } from './streams';
import type { Conflict, StatusText, VehicleState } from './Vehicle';
import { modeName } from './vehicleType';

const MAX_STATUS_TEXTS = 200;
/** Status texts whose last part is still missing; that of an older one was lost. */
const MAX_OPEN_TEXTS = 16;
/** Time in ms after which the share of lost packets is known. */
const LOSS_TIME = 5000;
/** A text in ms that the station received so much earlier or later than the page is another one. */
const SAME_TEXT_TIME = 3000;
/** Heartbeats come once a second; HIGH_LATENCY2, which replaces them, each 5 s (ArduPilot) or 67 s (PX4). */
const ALIVE_TIMEOUT = 5000;
const HIGH_LATENCY_TIMEOUT = 150_000;

export class StateTracker {
  private readonly draft: Draft;
  private readonly streams = new StreamWatch();
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
    if (message.name === 'HIGH_LATENCY2' && message.time - this.heartbeatTime < ALIVE_TIMEOUT) return null;
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
    if (name === 'AVAILABLE_MODES' && modeNames.size < MAX_MODES)
      modeNames.set(number(fields.custom_mode), String(fields.mode_name));
    draft.mode = modeName(draft.firmware, draft.type, draft.customMode) ?? modeNames.get(draft.customMode) ?? null;
  }

  /** Returns a copy of the state at a time in ms since 1970. */
  snapshot(now: number): VehicleState {
    this.draft.alive = now - this.heartbeatTime < ALIVE_TIMEOUT || now - this.summaryTime < HIGH_LATENCY_TIMEOUT;
    this.draft.overdue = this.draft.alive ? this.streams.overdue(now) : [];
    this.draft.inAir = isInAir(this.draft, now - this.landedTime);
    return { ...this.draft };
  }

  private heartbeatTime = 0;
  /** Of the last HIGH_LATENCY2. */
  private summaryTime = 0;
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
      this.streams.take(message.name, time);
      if (message.name === 'HEARTBEAT') [this.heartbeatTime, this.summaryTime] = [time, 0];
      if (message.name === 'HIGH_LATENCY2' && time - this.heartbeatTime >= ALIVE_TIMEOUT) this.summaryTime = time;
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
  'HEARTBEAT',
  'HIGH_LATENCY2',
  'SYS_STATUS',
  'ATTITUDE',
  'GLOBAL_POSITION_INT',
  'GPS_RAW_INT',
  'VFR_HUD',
  'EXTENDED_SYS_STATE',
  'BATTERY_STATUS',
  'HOME_POSITION',
  'EKF_STATUS_REPORT',
  'ESTIMATOR_STATUS',
  'VIBRATION',
  'FENCE_STATUS',
  'RC_CHANNELS',
  'RC_CHANNELS_RAW',
  'CURRENT_MODE',
  'AVAILABLE_MODES',
]);

/** Messages that tell the mode, or the name of one. */
const MODE_MESSAGES: ReadonlySet<string> = new Set([
  'HEARTBEAT',
  'HIGH_LATENCY2',
  'CURRENT_MODE',
  'AVAILABLE_MODES',
  'AUTOPILOT_VERSION',
]);
const MAX_MODES = 256;
