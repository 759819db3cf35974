import { describe, expect, it } from 'vitest';

import { CHECKSUMS, type ChecksumKind } from './checksums';
import { FrameReader, type FrameRow, parseDecoder, readDecoder } from './decoder';
import cases from './decoder-cases.json';
import { decodeCobs } from './framing';
import { DecoderError, fromHex, isHex, toHex } from './members';

/** Reads a stream in parts of some bytes. */
function readParts(reader: FrameReader, data: Uint8Array, size: number): FrameRow[] {
  const rows: FrameRow[] = [];
  for (let at = 0; at < data.length; at += size) rows.push(...reader.feed(data.slice(at, at + size)));
  return rows;
}

describe('frames', () => {
  it.each(cases.rows)('$name', ({ decoder, data, rows, refused }) => {
    const isStream = 'framing' in decoder;
    for (const size of isStream ? [1e6, 1, 7] : [1e6]) {
      const reader = new FrameReader(parseDecoder(decoder));
      const found = readParts(reader, fromHex(data), size);
      expect(found.map(({ message, fields }) => ({ message, fields }))).toEqual(rows);
      expect(reader.refused).toBe(refused);
    }
  });

  it('without a decoder each chunk is one, with its bytes', () => {
    expect(new FrameReader(null).feed(fromHex('01 02'))).toEqual([
      { message: 'FRAME', fields: { size: 2 }, data: fromHex('0102') },
    ]);
  });

  it('random bytes are never an error', () => {
    for (const { decoder } of cases.rows) {
      const reader = new FrameReader(parseDecoder(decoder));
      let seed = 7;
      const noise = Uint8Array.from({ length: 3000 }, () => (seed = (seed * 75 + 74) % 65_537) & 0xff);
      readParts(reader, noise, 113);
    }
  });
});

describe('declarations', () => {
  it.each(cases.refused)('are refused: $problem', ({ decoder, problem }) => {
    expect(() => parseDecoder(decoder)).toThrow(problem);
    expect(() => parseDecoder(decoder)).toThrow(DecoderError);
  });

  it('are read from texts', () => {
    expect(readDecoder('{"name": "bench"}').name).toBe('bench');
    expect(() => readDecoder('{')).toThrow('it is not JSON');
  });
});

it.each([
  ['sum8', 0xdd],
  ['sum16', 0x1dd],
  ['xor8', 0x31],
  ['fletcher8', 0x15dd],
  ['crc8', 0xf4],
  ['crc8-dvb-s2', 0xbc],
  ['crc8-maxim', 0xa1],
  ['crc16-ccitt', 0x29b1],
  ['crc16-xmodem', 0x31c3],
  ['crc16-x25', 0x906e],
  ['crc16-mcrf4xx', 0x6f91],
  ['crc16-modbus', 0x4b37],
  ['crc16-arc', 0xbb3d],
  ['crc32', 0xcbf43926],
] as const satisfies readonly (readonly [ChecksumKind, number])[])('%s has its check value', (kind, value) => {
  expect(CHECKSUMS[kind].of(new TextEncoder().encode('123456789'))).toBe(value);
});

it('COBS that is malformed has no bytes', () => {
  for (const text of ['00', '0501', '03 01 00', 'ff 01']) expect(decodeCobs(fromHex(text))).toBeNull();
});

it('bytes are written in hexadecimal digits', () => {
  expect(toHex(fromHex('AA 05ff'))).toBe('aa 05 ff');
  expect(isHex('0')).toBe(false);
});
