/**
 * Circles of ArduPilot's vehicles, which have no DO_ORBIT.
 *
 * A wing circles the place that it is sent to. A copter has the mode CIRCLE; since 4.1 CIRCLE_OPTIONS can make the
 * place where the mode is entered its centre. So it is sent to the centre first.
 */

import { StationError } from '$lib/api/errors';

import type { Parameter } from '../Vehicle';
import type { FlightSteps } from './flight';

/** The steps of a circle, which a vehicle takes. */
export interface CircleSteps extends Pick<FlightSteps, 'signal' | 'enter' | 'getParameter' | 'setParameter'> {
  /** The words of errors, such as `orbiting with 1/1`. */
  readonly operation: string;
  readonly isWing: boolean;
  /** Sends it to the centre; a wing circles it with a radius in metres, in direction 1 counter-clockwise. */
  goToCenter(radius: number, direction: number | null): Promise<unknown>;
  /** Returns the pulse of the throttle stick in µs; null: there is none. */
  throttle(): number | null;
  /** Returns metres to the centre; null: not known. */
  distance(): number | null;
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

/** Refuses a radius that no circle has. */
export function checkRadius(radius: number): void {
  if (Number.isFinite(radius) && radius !== 0) return;
  throw new StationError(
    'InvalidArgumentError',
    `orbit radius must be finite and not 0 (negative: counter-clockwise), got ${radius}`,
  );
}

/**
 * Circles the centre with a radius in metres (negative: counter-clockwise), at a speed in m/s or the one that is set.
 *
 * Where it fails, the parameters are as before.
 */
export async function circle(steps: CircleSteps, radius: number, speed: number | undefined): Promise<void> {
  if (steps.isWing) {
    await steps.enter(['GUIDED']);
    await steps.goToCenter(Math.abs(radius), radius < 0 ? 1 : 0);
    return;
  }
  const changed = new Map<string, number>();
  try {
    await circleAround(steps, changed, radius, speed);
  } catch (error) {
    for (const [name, value] of [...changed].reverse()) await steps.setParameter(name, value).catch(() => undefined);
    throw error;
  }
}

/** Lets a copter circle; `changed` gets the values that its parameters had. */
async function circleAround(
  steps: CircleSteps,
  changed: Map<string, number>,
  radius: number,
  speed: number | undefined,
): Promise<void> {
  const set = async ({ name, value: before }: Parameter, value: number): Promise<void> => {
    steps.signal.throwIfAborted();
    if (value === before) return;
    await steps.setParameter(name, value);
    changed.set(name, before);
  };
  checkThrottle(steps);
  const options = await optionsOf(steps);
  await set(options, options.value | CENTER_AT_ENTRY);
  await steps.enter(['GUIDED']);
  await steps.goToCenter(0, null);
  await arrival(steps);
  const metres = Math.abs(radius);
  // Its name and its unit changed: metres since 4.7.
  const earlier = await steps.getParameter('CIRCLE_RADIUS').catch(() => null);
  const [named, unit] = earlier === null ? [await steps.getParameter('CIRCLE_RADIUS_M'), 1] : [earlier, CENTIMETRES];
  await set(named, metres * unit);
  checkThrottle(steps);
  const rate = await steps.getParameter('CIRCLE_RATE');
  const degrees = speed === undefined ? rate.value : (speed / metres) * (180 / Math.PI);
  await set(rate, Math.sign(radius) * Math.abs(degrees));
  await steps.enter(['CIRCLE']);
}

function checkThrottle({ operation, throttle }: CircleSteps): void {
  const pulse = throttle();
  if (pulse === null || Math.abs(pulse - THROTTLE_MIDDLE) <= THROTTLE_DEAD_ZONE) return;
  const reason = `its throttle stick is at ${pulse} us and would change the altitude; center the stick`;
  throw new StationError('ActionUnsupported', `${operation} failed: ${reason}`);
}

function optionsOf(steps: CircleSteps): Promise<Parameter> {
  return steps.getParameter('CIRCLE_OPTIONS').catch(() => {
    throw new StationError(
      'ActionUnsupported',
      `${steps.operation} failed: its firmware has no CIRCLE_OPTIONS, which 4.1 introduced`,
    );
  });
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
