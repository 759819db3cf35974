/** The half of a vehicle that only receives: state, messages, status texts. Subclasses act. */

import { MavCmd } from '$generated';
import { StationError } from '$lib/api/errors';
import type { DecodedMessage, SentFields } from '$lib/decoder/Decoder';

import { UNKNOWN_CAPABILITIES, type Capabilities } from './capabilities';
import { StateTracker } from './StateTracker';
import {
  isAmbiguous,
  type Conflict,
  type MessageListener,
  type Plan,
  type StatusText,
  type VehicleState,
} from './Vehicle';

/** Sends a message by its name to all vehicles of the transport. */
export type Send = (name: string, fields: SentFields) => void;

export type Home = NonNullable<Plan['home']>;

/** Messages that ask and change nothing: they may go to both vehicles of a conflict. */
const READS: ReadonlySet<string> = new Set([
  'PARAM_REQUEST_READ',
  'PARAM_REQUEST_LIST',
  'MISSION_REQUEST_LIST',
  'MISSION_REQUEST_INT',
  'MISSION_ACK',
  'TIMESYNC',
  'PING',
]);
const READING_COMMANDS: ReadonlySet<unknown> = new Set([MavCmd.SET_MESSAGE_INTERVAL, MavCmd.REQUEST_MESSAGE]);

export class ObservedVehicle {
  readonly system: number;
  private readonly tracker: StateTracker;
  private readonly messageListeners = new Map<string, Set<MessageListener>>();
  private readonly stateListeners = new Set<(state: VehicleState) => void>();
  private readonly textListeners = new Set<(text: StatusText) => void>();
  private learned: StatusText[] = [];
  /** At once, unlike the state that views read. */
  conflict: Conflict | null = null;
  private dirty = true;
  private currentState: VehicleState = $state.raw() as unknown as VehicleState;
  protected currentCapabilities: Capabilities = $state.raw(UNKNOWN_CAPABILITIES);
  protected readonly send: Send;

  constructor(heartbeat: DecodedMessage, send: Send) {
    this.system = heartbeat.system;
    this.tracker = new StateTracker(heartbeat);
    this.currentState = this.tracker.snapshot(heartbeat.time);
    this.send = send;
  }

  get state(): VehicleState {
    return this.currentState;
  }

  get capabilities(): Capabilities {
    return this.currentCapabilities;
  }

  get component(): number {
    return this.currentState.component;
  }

  sendMessage(name: string, fields: SentFields): void {
    const reads = READS.has(name) || (name === 'COMMAND_LONG' && READING_COMMANDS.has(fields.command));
    if (this.isAmbiguous && !reads) return;
    this.send(name, { target_system: this.system, target_component: this.component, ...fields });
  }

  onMessage(name: string, listener: MessageListener): () => void {
    let listeners = this.messageListeners.get(name);
    if (listeners === undefined) this.messageListeners.set(name, (listeners = new Set()));
    listeners.add(listener);
    return () => listeners.delete(listener);
  }

  onState(listener: (state: VehicleState) => void): () => void {
    this.stateListeners.add(listener);
    return () => this.stateListeners.delete(listener);
  }

  onStatusText(listener: (text: StatusText) => void): () => void {
    this.textListeners.add(listener);
    return () => this.textListeners.delete(listener);
  }

  /** Takes a message as it arrives; the store calls it. */
  take(message: DecodedMessage): StatusText | null {
    this.dirty = true;
    const text = this.tracker.take(message);
    for (const name of [message.name, '*']) {
      for (const listener of this.messageListeners.get(name) ?? []) listener(message);
    }
    if (text !== null) for (const listener of this.textListeners) listener(text);
    return text;
  }

  /** Takes a home that the vehicle told before the page listened. */
  protected learnHome({ latitude, longitude, altitude }: Home): void {
    this.tracker.learnHome(latitude, longitude, altitude);
    this.dirty = true;
  }

  /** Shows that another vehicle uses the same system id; null: it does no more. */
  setConflict(conflict: Conflict | null): void {
    this.conflict = conflict;
    this.tracker.setConflict(conflict);
    this.dirty = true;
  }

  protected get isAmbiguous(): boolean {
    return isAmbiguous(this);
  }

  /** Throws if two vehicles would obey. */
  protected refuseInConflict(operation: string): void {
    if (!this.isAmbiguous) return;
    const reason = this.conflict?.text ?? '';
    throw new StationError('SystemIdConflictError', `${operation} ${this.system}/${this.component} failed: ${reason}`);
  }

  /** Takes texts that the vehicle sent before the page listened. */
  protected learnTexts(texts: readonly StatusText[]): void {
    const added = this.tracker.learnTexts(texts);
    this.learned.push(...added);
    if (added.length > 0) this.dirty = true;
  }

  /** Returns the texts that were learned since the last call; the store calls it. */
  takeLearned(): StatusText[] {
    return this.learned.splice(0);
  }

  /** Publishes the state, once per animation frame; the store calls it. */
  publish(now: number): void {
    const expired = this.currentState.alive && now - this.currentState.lastHeard > 5000;
    if (!this.dirty && !expired) return;
    this.dirty = false;
    this.currentState = this.tracker.snapshot(now);
    for (const listener of this.stateListeners) listener(this.currentState);
  }

  /** Ends timers and pending requests; the store calls it when the link is left. */
  dispose(): void {
    this.messageListeners.clear();
    this.stateListeners.clear();
    this.textListeners.clear();
  }
}
