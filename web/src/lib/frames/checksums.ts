/** Checksums of frames, as the station computes them (`server/rows/checksums.py`). */

interface Crc {
  readonly width: number;
  readonly polynomial: number;
  readonly initial: number;
  readonly reflected: boolean;
  readonly final: number;
}

interface Checksum {
  /** Its bytes in a frame. */
  readonly size: number;
  readonly of: (data: Uint8Array) => number;
}

function crc(width: number, polynomial: number, initial = 0, reflected = false, final = 0): Checksum {
  const parameters = { width, polynomial, initial, reflected, final };
  let table: readonly number[] | null = null;
  return {
    size: width / 8,
    of: (data) =>
      crcOf(parameters, (table ??= Array.from({ length: 256 }, (_, byte) => entry(parameters, byte))), data),
  };
}

function crcOf({ width, initial, reflected, final }: Crc, table: readonly number[], data: Uint8Array): number {
  let value = initial;
  const mask = 2 ** width - 1;
  for (const byte of data) {
    if (reflected) value = table[(value ^ byte) & 0xff]! ^ (value >>> 8);
    else value = (table[((value >>> (width - 8)) ^ byte) & 0xff]! ^ (value << 8)) & mask;
  }
  return (value ^ final) >>> 0;
}

function entry({ width, polynomial, reflected }: Crc, byte: number): number {
  const mask = 2 ** width - 1;
  let value = reflected ? byte : byte << (width - 8);
  const used = reflected
    ? parseInt([...polynomial.toString(2).padStart(width, '0')].reverse().join(''), 2)
    : polynomial;
  for (let bit = 0; bit < 8; bit++) {
    if (reflected) value = (value >>> 1) ^ (value & 1 ? used : 0);
    else value = ((value << 1) ^ (value & (2 ** (width - 1)) ? used : 0)) & mask;
  }
  return value;
}

function sum(size: number, of: Checksum['of']): Checksum {
  return { size, of };
}

/** The two sums of u-blox receivers; the first one is the low byte. */
function fletcher8(data: Uint8Array): number {
  let [first, second] = [0, 0];
  for (const byte of data) {
    first = (first + byte) & 0xff;
    second = (second + first) & 0xff;
  }
  return first | (second << 8);
}

const total = (data: Uint8Array): number => data.reduce((each, byte) => each + byte, 0);

export const CHECKSUMS = {
  sum8: sum(1, (data) => total(data) & 0xff),
  sum16: sum(2, (data) => total(data) & 0xffff),
  xor8: sum(1, (data) => data.reduce((each, byte) => each ^ byte, 0)),
  fletcher8: sum(2, fletcher8),
  crc8: crc(8, 0x07),
  'crc8-dvb-s2': crc(8, 0xd5),
  'crc8-maxim': crc(8, 0x31, 0, true),
  'crc16-ccitt': crc(16, 0x1021, 0xffff),
  'crc16-xmodem': crc(16, 0x1021),
  'crc16-x25': crc(16, 0x1021, 0xffff, true, 0xffff),
  'crc16-mcrf4xx': crc(16, 0x1021, 0xffff, true),
  'crc16-modbus': crc(16, 0x8005, 0xffff, true),
  'crc16-arc': crc(16, 0x8005, 0, true),
  crc32: crc(32, 0x04c11db7, 0xffffffff, true, 0xffffffff),
} as const satisfies Readonly<Record<string, Checksum>>;

export type ChecksumKind = keyof typeof CHECKSUMS;
