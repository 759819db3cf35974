/** The values in a frame: numbers of any size and byte order, texts, and arrays of numbers. */

export type Endian = 'little' | 'big';
export type Value = number | string | readonly (number | null)[];

interface NumberType {
  readonly size: number;
  readonly kind: 'signed' | 'unsigned' | 'float';
}

const unsigned = (size: number): NumberType => ({ size, kind: 'unsigned' });
const signed = (size: number): NumberType => ({ size, kind: 'signed' });
const float = (size: number): NumberType => ({ size, kind: 'float' });

export const NUMBERS = {
  int8: signed(1),
  uint8: unsigned(1),
  int16: signed(2),
  uint16: unsigned(2),
  int24: signed(3),
  uint24: unsigned(3),
  int32: signed(4),
  uint32: unsigned(4),
  int64: signed(8),
  uint64: unsigned(8),
  float16: float(2),
  float32: float(4),
  float64: float(8),
} as const satisfies Readonly<Record<string, NumberType>>;

export type NumberName = keyof typeof NUMBERS;

/** One number in a frame; a negative offset counts from the end of the frame. */
export interface NumberPlace {
  readonly offset: number;
  readonly type: NumberType;
  readonly endian: Endian;
}

/** A named value in a frame: `number * factor + add`. */
export interface FrameField {
  readonly name: string;
  readonly place: NumberPlace;
  /** The bytes that it takes; those of a text. */
  readonly size: number;
  /** The numbers of an array; 0: it is not an array. */
  readonly count: number;
  readonly isText: boolean;
  readonly bits: { readonly first: number; readonly count: number } | null;
  readonly factor: number;
  readonly add: number;
  readonly unit: string;
  readonly names: Readonly<Record<string, string>>;
}

/** Returns the index of an offset in a frame. */
export function indexOf(offset: number, length: number): number {
  return offset >= 0 ? offset : length + offset;
}

/** Returns whether a frame of so many bytes has a value. */
export function isInside(place: NumberPlace, size: number, length: number): boolean {
  const start = indexOf(place.offset, length);
  return start >= 0 && start <= length - size;
}

/** Returns the number of a place, exact for integers; the frame must be long enough. */
export function readNumber({ offset, type, endian }: NumberPlace, frame: Uint8Array, index = 0): number | bigint {
  const start = indexOf(offset, frame.length) + index * type.size;
  const bytes = frame.slice(start, start + type.size);
  if (endian === 'little') bytes.reverse();
  if (type.kind === 'float') return readFloat(bytes);
  let value = 0n;
  for (const byte of bytes) value = (value << 8n) | BigInt(byte);
  return type.kind === 'signed' ? BigInt.asIntN(type.size * 8, value) : value;
}

/** Returns the value of a field; null if it is not a finite number. */
export function readField(field: FrameField, frame: Uint8Array): Value | null {
  if (field.isText) return readText(field, frame);
  if (field.count === 0) return convert(field, readNumber(field.place, frame));
  return Array.from({ length: field.count }, (_, index) => scale(field, readNumber(field.place, frame, index)));
}

function readFloat(bytes: Uint8Array): number {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (bytes.length === 4) return view.getFloat32(0);
  return bytes.length === 8 ? view.getFloat64(0) : halfFloat(view.getUint16(0));
}

function halfFloat(bits: number): number {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 31) return fraction === 0 ? sign * Infinity : NaN;
  return exponent === 0 ? sign * fraction * 2 ** -24 : sign * (1024 + fraction) * 2 ** (exponent - 25);
}

function readText({ place, size }: FrameField, frame: Uint8Array): string {
  const start = indexOf(place.offset, frame.length);
  const bytes = frame.slice(start, start + size);
  const end = bytes.indexOf(0);
  return new TextDecoder('utf-8', { ignoreBOM: true }).decode(end < 0 ? bytes : bytes.slice(0, end));
}

function convert(field: FrameField, read: number | bigint): number | string | null {
  const { bits, names } = field;
  const number = bits === null ? read : (BigInt(read) >> BigInt(bits.first)) & ((1n << BigInt(bits.count)) - 1n);
  const name = String(number);
  return Object.hasOwn(names, name) ? names[name]! : scale(field, number);
}

function scale({ factor, add }: FrameField, number: number | bigint): number | null {
  const value = Number(number) * factor + add;
  return Number.isFinite(value) ? value : null;
}
