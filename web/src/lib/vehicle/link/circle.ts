/**
 * Circles of ArduPilot's vehicles, which have no DO_ORBIT.
 *
 * A wing circles the place that it is sent to. A copter has the mode CIRCLE; since 4.1 CIRCLE_OPTIONS can make the
 * place where the mode is entered its centre. So it is sent to the centre first.
 */

import { StationError } from '$lib/api/errors';

import type { Parameter } from '../Vehicle';

/** The steps of a circle, which a vehicle takes. */
export interface CircleSteps {
  /** The words of errors, such as `orbiting with 1/1`. */
  readonly operation: string;
  readonly isWing: boolean;
  /** Ends it: the pilot wants something else. */
  readonly signal: AbortSignal;
  enter(mode: string): Promise<void>;
  /** Sends it to the centre; a wing circles it with a radius in metres, in direction 1 counter-clockwise. */
  goToCenter(radius: number, direction: number | null): Promise<unknown>;
  /** Returns the pulse of the throttle stick in µs; null: there is none. */
  throttle(): number | null;
  /** Returns metres to the centre; null: not known. */
  distance(): number | null;
  getParameter(name: string): Promise<Parameter>;
  setParameter(name: string, value: number): Promise<unknown>;
}

/** Bit of CIRCLE_OPTIONS: the centre is where the mode is entered. */
const CENTER_AT_ENTRY = 4;
/** The throttle stick's middle and dead zone in µs: in CIRCLE a copter climbs and sinks by it. */
const [THROTTLE_MIDDLE, THROTTLE_DEAD_ZONE] = [1500, 100];
/** Metres from the centre at which a copter begins. */
const TOLERANCE = 3;
const POLL_INTERVAL = 250;
/** A copter that comes no nearer for this time in ms does not arrive. */
const MAX_STALL = 30_000;
const CENTIMETRES = 100;

/**
 * Circles the centre with a radius in metres (negative: counter-clockwise), at a speed in m/s or the one that is set.
 */
export async function circle(steps: CircleSteps, radius: number, speed: number | undefined): Promise<void> {
  if (!(Number.isFinite(radius) && radius !== 0)) {
    throw new StationError(
      'InvalidArgumentError',
      `orbit radius must be finite and not 0 (negative: counter-clockwise), got ${radius}`,
    );
  }
  if (steps.isWing) {
    await steps.enter('GUIDED');
    await steps.goToCenter(Math.abs(radius), radius < 0 ? 1 : 0);
    return;
  }
  checkThrottle(steps);
  await centerAtEntry(steps);
  await steps.enter('GUIDED');
  await steps.goToCenter(0, null);
  await arrival(steps);
  await setRadius(steps, Math.abs(radius));
  checkThrottle(steps);
  const rate =
    speed === undefined
      ? (await steps.getParameter('CIRCLE_RATE')).value
      : (speed / Math.abs(radius)) * (180 / Math.PI);
  await set(steps, 'CIRCLE_RATE', Math.sign(radius) * Math.abs(rate));
  await steps.enter('CIRCLE');
}

function checkThrottle({ operation, throttle }: CircleSteps): void {
  const pulse = throttle();
  if (pulse === null || Math.abs(pulse - THROTTLE_MIDDLE) <= THROTTLE_DEAD_ZONE) return;
  const reason = `its throttle stick is at ${pulse} us and would change the altitude; center the stick`;
  throw new StationError('ActionUnsupported', `${operation} failed: ${reason}`);
}

async function centerAtEntry(steps: CircleSteps): Promise<void> {
  const options = await steps.getParameter('CIRCLE_OPTIONS').catch(() => {
    throw new StationError(
      'ActionUnsupported',
      `${steps.operation} failed: its firmware has no CIRCLE_OPTIONS, which 4.1 introduced`,
    );
  });
  if ((options.value & CENTER_AT_ENTRY) === 0) await set(steps, 'CIRCLE_OPTIONS', options.value | CENTER_AT_ENTRY);
}

/** Sets the radius by the name and in the unit of the version: metres since 4.7. */
async function setRadius(steps: CircleSteps, metres: number): Promise<void> {
  const earlier = await steps.getParameter('CIRCLE_RADIUS').catch(() => null);
  if (earlier === null) await set(steps, 'CIRCLE_RADIUS_M', metres);
  else await set(steps, 'CIRCLE_RADIUS', metres * CENTIMETRES);
}

async function set(steps: CircleSteps, name: string, value: number): Promise<void> {
  steps.signal.throwIfAborted();
  await steps.setParameter(name, value);
}

/** Waits until the copter is at the centre. */
async function arrival(steps: CircleSteps): Promise<void> {
  let [nearest, waited] = [Infinity, 0];
  while (waited < MAX_STALL) {
    steps.signal.throwIfAborted();
    const left = steps.distance() ?? Infinity;
    if (left <= TOLERANCE) return;
    waited = left < nearest - 0.5 ? 0 : waited + POLL_INTERVAL;
    nearest = Math.min(nearest, left);
    await new Promise((resolve) => setTimeout(resolve, POLL_INTERVAL));
  }
  throw new StationError('ActionTimeout', `${steps.operation} failed: it comes no nearer to the centre`);
}
