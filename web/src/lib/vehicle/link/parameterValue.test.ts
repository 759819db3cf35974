import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, fieldBytes } from '$lib/decoder/Decoder';

import { decodeValue, encodeValue, encodingOf, floatText, isSame, typeName } from './parameterValue';

/** MAV_PARAM_TYPE with values at its ends, and such whose bytes are no number as a float. */
const VALUES: readonly (readonly [type: number, name: string, values: readonly number[]])[] = [
  [1, 'UINT8', [0, 1, 200, 255]],
  [2, 'INT8', [0, -1, -128, 127]],
  [3, 'UINT16', [0, 258, 65_535]],
  [4, 'INT16', [0, 258, -1, -32_768, 32_767]],
  [5, 'UINT32', [0, 16_909_060, 0x7f80_0001, 0xffff_ffff]],
  [6, 'INT32', [0, 16_909_060, 1, -1, -2, -5_000_000, -8_388_607, -(2 ** 31), 2 ** 31 - 1]],
];

/** Sends the value of a parameter in a packet and reads it again. */
function sent(value: number, type: number): number {
  const wire = encodeValue(value, type, 'bytewise')!;
  const packet = new Encoder(1, 1).build('PARAM_VALUE', {
    param_id: 'A',
    param_value: wire,
    param_type: type,
    param_count: 1,
  });
  const [message] = new Decoder().push(packet, 0);
  return decodeValue(fieldBytes(message!, 'param_value'), type, 'bytewise');
}

const bytesOf = (value: number): Uint8Array => new Uint8Array(Float32Array.of(value).buffer);

describe('values of parameters', () => {
  it.each(VALUES)('of type %i (%s) are the bytes of the float with PX4', (type, name, values) => {
    expect(typeName(type)).toBe(name);
    for (const value of values) expect([value, sent(value, type)]).toEqual([value, value]);
  });

  it('have the bytes of the integer at the begin of the float', () => {
    const encoded = [0x0102, -2].map((value) => [...(encodeValue(value, 4, 'bytewise') as Uint8Array)]);
    expect(encoded).toEqual([
      [2, 1, 0, 0],
      [0xfe, 0xff, 0, 0],
    ]);
    expect(encodeValue(-1, 2, 'bytewise')).toEqual(Uint8Array.of(0xff, 0, 0, 0));
    expect(decodeValue(Uint8Array.of(2, 1, 0, 0), 6, 'bytewise')).toBe(0x0102);
  });

  it.each(VALUES)('are not sent where type %i (%s) cannot hold them', (type, _, values) => {
    const [smallest, largest] = [Math.min(...values), Math.max(...values)];
    for (const wrong of [smallest - 1, largest + 1, 1.5, NaN, Infinity]) {
      for (const encoding of ['cast', 'bytewise'] as const) expect(encodeValue(wrong, type, encoding)).toBeNull();
    }
  });

  it('are the same if their floats are, and integers only if they are equal', () => {
    expect(isSame(0.1, Math.fround(0.1), 9, 'bytewise')).toBe(true);
    expect(isSame(16_777_217, 16_777_216, 6, 'bytewise')).toBe(false);
    expect(isSame(16_777_217, 16_777_216, 6, 'cast')).toBe(true);
  });

  it('are the number itself with ArduPilot, and where they are floats', () => {
    expect([encodeValue(300, 4, 'cast'), decodeValue(bytesOf(300), 4, 'cast')]).toEqual([300, 300]);
    expect([encodeValue(1.5, 9, 'bytewise'), decodeValue(bytesOf(1.5), 9, 'bytewise')]).toEqual([1.5, 1.5]);
    expect(['ardupilot', 'px4', 'msp', 'generic'].map((each) => encodingOf(each as 'px4'))).toEqual([
      'cast',
      'bytewise',
      'bytewise',
      null,
    ]);
  });

  it('are written with the digits that mean the same float', () => {
    expect([0.1, 16_777_216, 2.7182817, 1 / 3, -0.05].map((each) => floatText(Math.fround(each)))).toEqual([
      '0.1',
      '16777216',
      '2.7182817',
      '0.33333334',
      '-0.05',
    ]);
    expect(floatText(NaN)).toBe('NaN');
  });
});
