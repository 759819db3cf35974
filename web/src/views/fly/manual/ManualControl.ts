/**
 * Control by sticks: MANUAL_CONTROL 50 times a second, under a dead-man rule.
 *
 * Messages are sent only while a hand holds the dead-man button (or the sticks on the screen). Letting go, a hidden
 * page, another window with the focus, a controller that is pulled out, a lost link or another vehicle stop it at once:
 * the sticks are sent centred, then nothing more. After anything but letting go, and after it is switched on, the
 * button must be released and pressed again.
 */

export const SEND_INTERVAL = 20;
/** A page that was frozen for longer must not go on with old sticks. */
const MAX_GAP = 500;
/** Centred sticks are sent several times, because single packets may be lost. */
const NEUTRAL_REPEATS = 3;

/** Sticks between -1 and 1; right, forward, up and clockwise are positive. */
export interface Sticks {
  readonly roll: number;
  readonly pitch: number;
  readonly throttle: number;
  readonly yaw: number;
  /** Bit field of MANUAL_CONTROL. */
  readonly buttons: number;
  /** The dead-man button is held. */
  readonly isHeld: boolean;
}

export interface Conditions {
  readonly isEnabled: boolean;
  /** The page is shown and has the focus. */
  readonly isVisible: boolean;
  readonly isLinked: boolean;
  /** The vehicle to control; null if there is none. */
  readonly system: number | null;
  /** Its heartbeats arrive. */
  readonly isHeard: boolean;
  readonly throttle: ThrottleKind;
}

/**
 * How MANUAL_CONTROL counts the throttle: `centred` 0 … 1000 with 500 as neutral (copters, submarines, PX4), `reverse`
 * -1000 … 1000 (rovers and boats of ArduPilot), `forward` 0 … 1000 without a neutral: planes keep their last throttle.
 */
export type ThrottleKind = 'centred' | 'reverse' | 'forward';

export type ManualState = 'off' | 'ready' | 'active' | 'blocked';
export type StopReason = 'released' | 'hidden' | 'link' | 'controller' | 'vehicle' | 'contact' | 'frozen' | null;

export interface ManualFields {
  readonly x: number;
  readonly y: number;
  readonly z: number;
  readonly r: number;
  readonly buttons: number;
  readonly [name: string]: number;
}

/** Return the kind of throttle of a vehicle. */
export function throttleKind(firmware: string, vehicleType: string): ThrottleKind {
  if (vehicleType === 'plane' || vehicleType === 'vtol') return 'forward';
  const isGround = vehicleType === 'rover' || vehicleType === 'boat';
  return firmware === 'ardupilot' && isGround ? 'reverse' : 'centred';
}

const scaled = (value: number): number => Math.round(Math.max(-1, Math.min(1, value)) * 1000);

/** Return the fields of MANUAL_CONTROL for sticks. */
export function manualFields(sticks: Sticks, throttle: ThrottleKind): ManualFields {
  const up = scaled(sticks.throttle);
  const z = throttle === 'reverse' ? up : Math.round((up + 1000) / 2);
  return { x: scaled(sticks.pitch), y: scaled(sticks.roll), z, r: scaled(sticks.yaw), buttons: sticks.buttons };
}

export class ManualControl {
  state: ManualState = 'off';
  /** Why it is not active, after it was. */
  reason: StopReason = null;
  private readonly send: (system: number, fields: ManualFields) => void;
  private last: { system: number; throttle: ThrottleKind; fields: ManualFields; time: number } | null = null;
  private mustRelease = true;

  constructor(send: (system: number, fields: ManualFields) => void) {
    this.send = send;
  }

  /** Read the sticks, send what the rule allows; called every `SEND_INTERVAL` with the time in ms. */
  tick(now: number, sticks: Sticks | null, conditions: Conditions): void {
    const problem = this.problem(now, sticks, conditions);
    const wantsHand = sticks?.isHeld ?? false;
    // A controller that is away does not tell that its button was released.
    if (sticks !== null && !wantsHand) this.mustRelease = false;
    if (!conditions.isEnabled) {
      this.stop('released', conditions.isLinked);
      this.state = 'off';
      this.reason = null;
      this.mustRelease = true;
      return;
    }
    if (problem !== null) {
      // A hand that still holds the button must let go before sticks count again.
      this.mustRelease ||= wantsHand || this.last !== null;
      this.stop(problem, conditions.isLinked);
      this.state = 'blocked';
      this.reason = problem;
      return;
    }
    if (!wantsHand || this.mustRelease) {
      this.stop('released', true);
      this.state = this.mustRelease ? 'blocked' : 'ready';
      // It is back, and its button is held: that is what the hand can change.
      if (this.reason === 'controller') this.reason = 'released';
      return;
    }
    const system = conditions.system!;
    const fields = manualFields(sticks!, conditions.throttle);
    this.send(system, fields);
    this.last = { system, throttle: conditions.throttle, fields, time: now };
    this.state = 'active';
    this.reason = null;
  }

  /** Stop at once, without waiting for the next tick: the page is hidden or left. */
  halt(reason: Exclude<StopReason, null>, isLinked = true): void {
    if (this.last === null) return;
    this.mustRelease = true;
    this.stop(reason, isLinked);
    this.state = 'blocked';
  }

  private problem(now: number, sticks: Sticks | null, conditions: Conditions): StopReason {
    if (!conditions.isVisible) return 'hidden';
    if (!conditions.isLinked) return 'link';
    if (conditions.system === null) return 'vehicle';
    if (!conditions.isHeard) return 'contact';
    if (sticks === null) return 'controller';
    if (this.last === null) return null;
    if (conditions.system !== this.last.system) return 'vehicle';
    return now - this.last.time > MAX_GAP ? 'frozen' : null;
  }

  private stop(reason: Exclude<StopReason, null>, isLinked: boolean): void {
    const { last } = this;
    if (last === null) return;
    this.last = null;
    this.reason = reason;
    if (!isLinked) return;
    const z = last.throttle === 'centred' ? 500 : last.throttle === 'reverse' ? 0 : last.fields.z;
    for (let count = 0; count < NEUTRAL_REPEATS; count += 1) {
      this.send(last.system, { x: 0, y: 0, z, r: 0, buttons: 0 });
    }
  }
}
