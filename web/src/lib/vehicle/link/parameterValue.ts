/**
 * Values of parameters in the float of PARAM_VALUE.
 *
 * ArduPilot casts integers to float; PX4 puts the bytes of the integer into the four bytes of the float.
 */

import { MavParamType } from '$generated';
import { enumName } from '$lib/decoder/Decoder';

import type { VehicleState } from '../Vehicle';

export type ParameterEncoding = 'cast' | 'bytewise';

/** Returns the encoding of a firmware; null if it is not known. */
export function encodingOf(firmware: VehicleState['firmware']): ParameterEncoding | null {
  if (firmware === 'ardupilot') return 'cast';
  return firmware === 'px4' || firmware === 'msp' ? 'bytewise' : null;
}

/** The smallest and the largest value of each MAV_PARAM_TYPE of integers. */
const LIMITS: ReadonlyMap<number, readonly [smallest: number, largest: number]> = new Map([
  [MavParamType.UINT8, [0, 2 ** 8 - 1]],
  [MavParamType.INT8, [-(2 ** 7), 2 ** 7 - 1]],
  [MavParamType.UINT16, [0, 2 ** 16 - 1]],
  [MavParamType.INT16, [-(2 ** 15), 2 ** 15 - 1]],
  [MavParamType.UINT32, [0, 2 ** 32 - 1]],
  [MavParamType.INT32, [-(2 ** 31), 2 ** 31 - 1]],
]);

/**
 * Returns the value of a parameter from the bytes of the float on the wire.
 *
 * Bytes, since a float does not keep those of every integer: those of -5,000,000 are a NaN, and become those of
 * another one.
 */
export function decodeValue(bytes: Uint8Array, type: number, encoding: ParameterEncoding): number {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const limits = LIMITS.get(type);
  if (encoding === 'cast' || limits === undefined) return view.getFloat32(0, true);
  const [smallest, largest] = limits;
  if (largest < 2 ** 8) return smallest < 0 ? view.getInt8(0) : view.getUint8(0);
  if (largest < 2 ** 16) return smallest < 0 ? view.getInt16(0, true) : view.getUint16(0, true);
  return smallest < 0 ? view.getInt32(0, true) : view.getUint32(0, true);
}

/** Returns the float on the wire for the value of a parameter, or its bytes; null if the type cannot hold the value. */
export function encodeValue(value: number, type: number, encoding: ParameterEncoding): number | Uint8Array | null {
  const limits = LIMITS.get(type);
  if (limits === undefined) return value;
  if (!Number.isInteger(value) || value < limits[0] || value > limits[1]) return null;
  if (encoding === 'cast') return value;
  const bytes = new Uint8Array(4);
  // Two's complement, whose lower bytes are those of the smaller types.
  new DataView(bytes.buffer).setUint32(0, value, true);
  return limits[1] < 2 ** 8 ? bytes.fill(0, 1) : limits[1] < 2 ** 16 ? bytes.fill(0, 2) : bytes;
}

/** Returns whether two values of a type are the same one; floats have 32 bits on the wire. */
export function isSame(one: number, other: number, type: number, encoding: ParameterEncoding): boolean {
  return encoding === 'bytewise' && type !== MavParamType.REAL32
    ? one === other
    : Math.fround(one) === Math.fround(other);
}

/** Returns the name of a MAV_PARAM_TYPE without its prefix, such as `REAL32`. */
export function typeName(type: number): string {
  return enumName('MAV_PARAM_TYPE', type) ?? 'REAL32';
}

/** Returns the shortest text that means the same 32-bit float. */
export function floatText(value: number): string {
  if (!Number.isFinite(value)) return String(value);
  for (let digits = 1; digits < 9; digits += 1) {
    const text = value.toPrecision(digits);
    if (Math.fround(Number(text)) === Math.fround(value)) return String(Number(text));
  }
  return String(Number(value.toPrecision(9)));
}
