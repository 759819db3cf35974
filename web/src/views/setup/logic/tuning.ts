/**
 * The answer of a vehicle to its set-points, from the messages that it sends.
 *
 * Rates: ATTITUDE_TARGET against ATTITUDE; angles: the quaternion of ATTITUDE_TARGET, or NAV_CONTROLLER_OUTPUT of a
 * plane, against ATTITUDE. PID_TUNING of ArduPilot has both sides of the rate of the axis that GCS_PID_MASK selects.
 */

import { AttitudeTargetTypemask, PidTuningAxis } from '$generated';

import type { TunedAxis } from './sections';

export type TuningKind = 'rate' | 'angle';

/** Degrees, or degrees per second; undefined: the message does not have it. */
export interface TuningSample {
  readonly setpoint?: number;
  readonly response?: number;
}

export type Fields = Readonly<Record<string, unknown>>;

/** Bits of `type_mask` in ATTITUDE_TARGET that mark values to be ignored. */
const IGNORED_RATE: Readonly<Record<TunedAxis, number>> = {
  roll: AttitudeTargetTypemask.BODY_ROLL_RATE_IGNORE,
  pitch: AttitudeTargetTypemask.BODY_PITCH_RATE_IGNORE,
  yaw: AttitudeTargetTypemask.BODY_YAW_RATE_IGNORE,
};
const PID_AXES: Readonly<Record<TunedAxis, number>> = {
  roll: PidTuningAxis.ROLL,
  pitch: PidTuningAxis.PITCH,
  yaw: PidTuningAxis.YAW,
};

const degrees = (radians: number): number => (radians * 180) / Math.PI;

/** Returns the values of a message for an axis; empty: it has none. */
export function tuningSample(name: string, fields: Fields, axis: TunedAxis, kind: TuningKind): TuningSample {
  switch (name) {
    case 'ATTITUDE':
      return { response: degrees(Number(fields[kind === 'rate' ? `${axis}speed` : axis])) };
    case 'ATTITUDE_TARGET':
      return targetSample(fields, axis, kind);
    case 'NAV_CONTROLLER_OUTPUT':
      return kind === 'angle' && axis !== 'yaw' ? { setpoint: Number(fields[`nav_${axis}`]) } : {};
    case 'PID_TUNING':
      return kind === 'rate' && Number(fields.axis) === PID_AXES[axis]
        ? { setpoint: Number(fields.desired), response: Number(fields.achieved) }
        : {};
    default:
      return {};
  }
}

function targetSample(fields: Fields, axis: TunedAxis, kind: TuningKind): TuningSample {
  const mask = Number(fields.type_mask);
  if (kind === 'rate') {
    return mask & IGNORED_RATE[axis] ? {} : { setpoint: degrees(Number(fields[`body_${axis}_rate`])) };
  }
  return mask & AttitudeTargetTypemask.ATTITUDE_IGNORE
    ? {}
    : { setpoint: degrees(eulerOf(fields.q as readonly number[])[axis]) };
}

/** Returns roll, pitch and yaw of a quaternion in radians. */
export function eulerOf([w = 1, x = 0, y = 0, z = 0]: readonly number[]): Readonly<Record<TunedAxis, number>> {
  return {
    roll: Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    pitch: Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
    yaw: Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  };
}

/** Numbers of how well a response follows its set-point; null: there are too few values. */
export interface Following {
  /** Root of the mean squared difference. */
  readonly error: number;
  /** Milliseconds by which the response is late. */
  readonly delay: number;
}

const MIN_VALUES = 20;
const STEP = 20;
const MAX_DELAY = 400;

/** Returns the delay at which the response fits the set-point best, and the difference without it. */
export function followingOf(setpoints: Samples, responses: Samples): Following | null {
  if (setpoints.length < MIN_VALUES || responses.length < MIN_VALUES) return null;
  const differences: { delay: number; error: number }[] = [];
  for (let delay = 0; delay <= MAX_DELAY; delay += STEP) {
    differences.push({ delay, error: differenceAt(setpoints, responses, delay) });
  }
  const best = differences.reduce((one, other) => (other.error < one.error - 1e-9 ? other : one));
  return { error: differences[0]!.error, delay: best.delay };
}

/** Values over time, as a `Ring` has them. */
export interface Samples {
  readonly length: number;
  timeAt(index: number): number;
  valueAt(index: number): number;
}

function differenceAt(setpoints: Samples, responses: Samples, delay: number): number {
  let [sum, count, place] = [0, 0, 0];
  for (let index = 0; index < responses.length; index += 1) {
    const time = responses.timeAt(index) - delay;
    while (place + 1 < setpoints.length && setpoints.timeAt(place + 1) <= time) place += 1;
    if (setpoints.timeAt(place) > time) continue;
    sum += (responses.valueAt(index) - setpoints.valueAt(place)) ** 2;
    count += 1;
  }
  return count === 0 ? Infinity : Math.sqrt(sum / count);
}
