/**
 * Params 5 and 6 of commands and mission items: degrees and metres in the page, scaled integers on the wire.
 *
 * COMMAND_INT and MISSION_ITEM_INT carry them as int32: degrees times 1e7 in a global frame, metres times 1e4 in a
 * local one, and unscaled where the command has no place. INT32_MAX stands for NaN.
 */

import { MavFrame } from '$generated';

import located from '../../../generated/located.json';

const UNKNOWN = 0x7fffffff;
const GLOBAL_FRAMES: ReadonlySet<number> = new Set([
  MavFrame.GLOBAL,
  MavFrame.GLOBAL_RELATIVE_ALT,
  MavFrame.GLOBAL_INT,
  MavFrame.GLOBAL_RELATIVE_ALT_INT,
  MavFrame.GLOBAL_TERRAIN_ALT,
  MavFrame.GLOBAL_TERRAIN_ALT_INT,
]);
const LOCATED: ReadonlySet<number> = new Set(located);

/** Returns the frame in which a command is sent as integers that was given without one. */
export function frameOf(command: number): number {
  return LOCATED.has(command) ? MavFrame.GLOBAL_RELATIVE_ALT : MavFrame.MISSION;
}

/** Returns the factor of params 5 and 6 of a command in an integer message. */
export function scaleOf(command: number, frame: number): number {
  if (!LOCATED.has(command) || frame === MavFrame.MISSION) return 1;
  return GLOBAL_FRAMES.has(frame) ? 1e7 : 1e4;
}

/** Returns a coordinate for an integer message; null, which is NaN, and values out of range are INT32_MAX. */
export function toInteger(value: number | null, scale: number): number {
  const scaled = Math.round((value ?? NaN) * scale);
  return scaled >= -(2 ** 31) && scaled <= UNKNOWN ? scaled : UNKNOWN;
}

/** Returns the coordinate of an integer message; null stands for NaN. */
export function fromInteger(value: number, scale: number): number | null {
  return value === UNKNOWN && scale !== 1 ? null : value / scale;
}
