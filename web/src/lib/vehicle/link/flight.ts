/** The steps of arming, takeoff and mission start; where one is refused, the vehicle is as it was before. */

import { StationError } from '$lib/api/errors';

import { ON_SURFACE } from '../inAir';
import type { CommandResult, Parameter, VehicleState } from '../Vehicle';
import { allowsArming, MISSION_MODES, startsByItself, waitingMode } from './modes';

/** Value that makes ArduPilot and PX4 arm or disarm without their checks. */
export const FORCE = 21196;
const NO_LANDING = 'its mission has no landing sequence and it has no AUTOLAND mode: let it return home';

export interface FlightFacts {
  /** The state when the action was given. */
  readonly state: VehicleState;
  /** Returns the error of the action; its kind is `InvalidStateError` unless another one is given. */
  failure(reason: string, kind?: string): StationError;
}

export interface FlightSteps extends FlightFacts {
  readonly signal: AbortSignal;
  /** Whether a mode was requested. */
  entered: boolean;
  /** Enters the first of some modes that the vehicle has. */
  enter(modes: readonly string[]): Promise<void>;
  send(command: string, params: readonly (number | null)[]): Promise<CommandResult>;
  getParameter(name: string): Promise<Parameter>;
  setParameter(name: string, value: number): Promise<Parameter>;
}

/**
 * Returns why a vehicle cannot take an action that flies it, as far as it reports that; null: it can.
 *
 * These are the preconditions of `mavstack.vehicle` (actions/preconditions.py): a return or a hold of a disarmed
 * vehicle would only leave a mode behind, and a plane on the ground would run at full throttle to its goal.
 */
export function reasonAgainstFlight(state: VehicleState, needsAir: boolean): string | null {
  if (state.armed === false) return 'it is not armed; arm it first';
  return needsAir && state.inAir === false && !ON_SURFACE.has(state.type)
    ? 'it is on the ground; take off first'
    : null;
}

/** Lets steps note that a mode was requested. */
export function noteModes(steps: FlightSteps): FlightSteps {
  const { enter } = steps;
  steps.enter = (modes) => {
    steps.entered = true;
    return enter(modes);
  };
  return steps;
}

/** Does something that begins with a change of the mode; where it fails, the vehicle gets its mode back. */
export async function orRestoreMode<Result>(steps: FlightSteps, act: () => Promise<Result>): Promise<Result> {
  const { state, signal } = steps;
  try {
    return await act();
  } catch (error) {
    // A later command of the pilot has chosen what follows.
    if (steps.entered && state.mode !== null && !signal.aborted) await steps.enter([state.mode]).catch(() => undefined);
    throw error;
  }
}

/**
 * Arms, in another mode if the firmware does not arm in this one.
 *
 * @param options.leavesStarting - Leave a mode, too, in which the vehicle would start by itself, instead of refusing.
 */
export async function armFirst(steps: FlightSteps, { force = false, leavesStarting = false } = {}): Promise<void> {
  const { state } = steps;
  const waiting = waitingMode(state);
  const arm = async (): Promise<void> => {
    await steps.send('COMPONENT_ARM_DISARM', [1, force ? FORCE : 0]);
  };
  if (state.armed === true) return arm();
  if (waiting !== null && (!allowsArming(state) || (leavesStarting && startsByItself(state)))) {
    return orRestoreMode(steps, async () => {
      await steps.enter([waiting]);
      await arm();
    });
  }
  if (!startsByItself(state)) return arm();
  const remedy = waiting === null ? 'change the mode first' : `change the mode to ${waiting} first`;
  throw steps.failure(`in mode ${state.mode} it would start by itself: ${remedy}`);
}

/** Takes off in the mode TAKEOFF: ArduPlane takes NAV_TAKEOFF in missions only. */
export async function takeOffInMode(steps: FlightSteps, altitude: number): Promise<void> {
  const before = await steps.getParameter('TKOFF_ALT');
  steps.signal.throwIfAborted();
  await steps.setParameter('TKOFF_ALT', altitude);
  try {
    await steps.enter(['TAKEOFF']);
  } catch (error) {
    await steps.setParameter('TKOFF_ALT', before.value).catch(() => undefined);
    throw error;
  }
}

/** Starts the landing sequence of the mission; a plane without one lands in AUTOLAND, which Plane 4.7 has. */
export async function landByMission(steps: FlightSteps): Promise<void> {
  try {
    await steps.send('DO_LAND_START', []);
  } catch (error) {
    if (!(error instanceof StationError) || error.kind !== 'CommandDenied') throw error;
    await steps.enter(['AUTOLAND']).catch((reason: unknown) => {
      throw steps.signal.aborted ? reason : steps.failure(NO_LANDING, 'CommandDenied');
    });
  }
}

/**
 * Starts the mission; a disarmed vehicle is armed first if that is allowed, and disarmed again if it refuses the
 * mission.
 */
export async function startMission(steps: FlightSteps, arm: boolean): Promise<void> {
  const start = async (): Promise<void> => {
    await steps.enter(MISSION_MODES);
    await steps.send('MISSION_START', []);
  };
  if (steps.state.armed === true) return orRestoreMode(steps, start);
  if (!arm) throw steps.failure('it is not armed');
  await orRestoreMode(steps, async () => {
    await armFirst(steps, { leavesStarting: true });
    await start().catch(async (error: unknown) => {
      if (!steps.signal.aborted) await steps.send('COMPONENT_ARM_DISARM', [0, 0]).catch(() => undefined);
      throw error;
    });
  });
}
