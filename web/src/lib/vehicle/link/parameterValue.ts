/**
 * Values of parameters in the float of PARAM_VALUE.
 *
 * ArduPilot casts integers to float; PX4 puts the bytes of the integer into the four bytes of the float.
 */

import { enumName } from '$lib/decoder/Decoder';

import type { VehicleState } from '../Vehicle';

export type ParameterEncoding = 'cast' | 'bytewise';

/** Returns the encoding of a firmware; null if it is not known. */
export function encodingOf(firmware: VehicleState['firmware']): ParameterEncoding | null {
  if (firmware === 'ardupilot') return 'cast';
  return firmware === 'px4' || firmware === 'msp' ? 'bytewise' : null;
}

const UINT8 = 1;
const INT8 = 2;
const UINT16 = 3;
const INT16 = 4;
const UINT32 = 5;
const INT32 = 6;
const REAL32 = 9;

const view = new DataView(new ArrayBuffer(4));

/** Returns the value of a parameter from the float on the wire. */
export function decodeValue(wire: number, type: number, encoding: ParameterEncoding): number {
  if (encoding === 'cast' || type === REAL32) return wire;
  view.setFloat32(0, wire, true);
  switch (type) {
    case UINT8:
      return view.getUint8(0);
    case INT8:
      return view.getInt8(0);
    case UINT16:
      return view.getUint16(0, true);
    case INT16:
      return view.getInt16(0, true);
    case UINT32:
      return view.getUint32(0, true);
    case INT32:
      return view.getInt32(0, true);
    default:
      return wire;
  }
}

/** Returns the float on the wire for the value of a parameter. */
export function encodeValue(value: number, type: number, encoding: ParameterEncoding): number {
  if (encoding === 'cast' || type === REAL32) return value;
  view.setUint32(0, 0);
  if (type === UINT8 || type === INT8) view.setInt8(0, value);
  else if (type === UINT16 || type === INT16) view.setInt16(0, value, true);
  else view.setInt32(0, value, true);
  return view.getFloat32(0, true);
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
