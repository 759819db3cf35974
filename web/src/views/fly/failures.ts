/** Failures on purpose: names for people, and the parameters of the command. */

import { enumValues } from '$lib/decoder/Decoder';

/** Returns the name of a FAILURE_UNIT for people: `optical flow` for `SENSOR_OPTICAL_FLOW`. */
export function unitName(unit: string): string {
  return unit
    .replace(/^(SENSOR|SYSTEM)_/, '')
    .replaceAll('_', ' ')
    .toLowerCase();
}

/** Returns the parameters of INJECT_FAILURE for a FAILURE_UNIT, a FAILURE_TYPE, and the number of the unit (0: all). */
export function failureParams(unit: string, way: string, number: number): number[] {
  return [Number(enumValues('FAILURE_UNIT')?.[unit]), Number(enumValues('FAILURE_TYPE')?.[way]), number];
}
