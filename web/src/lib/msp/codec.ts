/** Payloads of MSP messages to fields and back, by the generated tables. */

import { messageFacts, type CodecFacts, type FieldFacts, type Firmware, type NumberFacts } from './facts';

export type MspValue = number | boolean | string | readonly MspValue[] | MspFields;
export interface MspFields {
  readonly [name: string]: MspValue;
}

const SIZES = { u8: 1, i8: 1, u16: 2, i16: 2, u32: 4, i32: 4 } as const;
const decoder = new TextDecoder();
const encoder = new TextEncoder();

class Reader {
  values: Record<string, MspValue> = {};
  private offset = 0;
  private readonly view: DataView;
  readonly firmware: Firmware;

  constructor(payload: Uint8Array, firmware: Firmware) {
    this.view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    this.firmware = firmware;
  }

  get remaining(): number {
    return this.view.byteLength - this.offset;
  }

  take(count: number): DataView {
    if (count > this.remaining) throw new RangeError(`${count - this.remaining} more bytes are needed`);
    const start = this.view.byteOffset + this.offset;
    this.offset += count;
    return new DataView(this.view.buffer, start, count);
  }

  bytes(count: number): Uint8Array {
    const { buffer, byteOffset } = this.take(count);
    return new Uint8Array(buffer, byteOffset, count);
  }

  byte(): number {
    return this.take(1).getUint8(0);
  }
}

/** Returns the fields of a payload; bytes behind the last known field are ignored. */
export function decodeMessage(name: string, payload: Uint8Array, firmware: Firmware): MspFields {
  try {
    return decodeFields(messageFacts(name).fields, new Reader(payload, firmware));
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
    throw new RangeError(`decoding ${messageFacts(name).name} failed: ${error.message}`);
  }
}

/** Returns the payload of a message; fields that the firmware does not know are left out. */
export function encodeMessage(name: string, values: MspFields, firmware: Firmware): Uint8Array {
  const out: number[] = [];
  encodeFields(messageFacts(name).fields, values, firmware, out);
  return Uint8Array.from(out);
}

const isIn = ({ variant }: FieldFacts, firmware: Firmware): boolean => !variant || variant === firmware.variant;

function isTooNew({ since }: FieldFacts, { variant, api }: Firmware): boolean {
  if (variant === 'INAV' || !since || (api[0] === 0 && api[1] === 0)) return false;
  const [major = 0, minor = 0] = since.split('.').map(Number);
  return api[0] < major || (api[0] === major && api[1] < minor);
}

function decodeFields(fields: readonly FieldFacts[], reader: Reader): MspFields {
  const values: Record<string, MspValue> = {};
  reader.values = values;
  for (const field of fields) {
    if (!isIn(field, reader.firmware)) continue;
    if (reader.remaining === 0 && field.optional) break;
    values[field.name] = decode(field.codec, reader);
    reader.values = values;
  }
  return values;
}

function decode(codec: CodecFacts, reader: Reader): MspValue {
  switch (codec.kind) {
    case 'variant':
      return decode(codec[reader.firmware.variant], reader);
    case 'record':
      return decodeFields(codec.fields, reader);
    case 'items':
      return decodeItems(codec, reader);
    case 'text':
      return trimmed(decoder.decode(reader.bytes(codec.length)), codec.fill);
    case 'prefixed': {
      const text = decoder.decode(reader.bytes(reader.byte()));
      return codec.length > 0 ? trimmed(text, codec.fill) : text;
    }
    case 'rest':
      return decoder.decode(reader.bytes(reader.remaining)).split('\0')[0]!;
    case 'names':
      return decoder
        .decode(reader.bytes(reader.remaining))
        .split(';')
        .filter((name) => name !== '');
    case 'bytes':
      return [...reader.bytes(codec.length ?? reader.remaining)];
    case 'counted':
      return [...reader.bytes(reader.byte())];
    default:
      return decodeNumber(codec, reader.take(SIZES[codec.kind]));
  }
}

function decodeItems(codec: Extract<CodecFacts, { kind: 'items' }>, reader: Reader): MspValue[] {
  const { values } = reader;
  const counted = codec.counted ? reader.byte() : codec.count;
  const count = codec.countField ? Number(values[codec.countField]) : counted;
  const items: MspValue[] = [];
  if (count !== undefined) for (let index = 0; index < count; index += 1) items.push(decode(codec.item, reader));
  else while (reader.remaining > (codec.leave ?? 0)) items.push(decode(codec.item, reader));
  return items;
}

function trimmed(text: string, fill: string): string {
  let end = text.length;
  while (end > 0 && (text[end - 1] === fill || text[end - 1] === '\0')) end -= 1;
  return text.slice(0, end);
}

function decodeNumber({ kind, perUnit = 1, step = 1, offset = 0, isBool }: NumberFacts, view: DataView): MspValue {
  const raw = rawOf(kind, view);
  if (isBool) return raw !== 0;
  return (offset + raw * step) / perUnit;
}

function rawOf(kind: NumberFacts['kind'], view: DataView): number {
  switch (kind) {
    case 'u8':
      return view.getUint8(0);
    case 'i8':
      return view.getInt8(0);
    case 'u16':
      return view.getUint16(0, true);
    case 'i16':
      return view.getInt16(0, true);
    case 'u32':
      return view.getUint32(0, true);
    case 'i32':
      return view.getInt32(0, true);
  }
}

function encodeFields(fields: readonly FieldFacts[], values: MspFields, firmware: Firmware, out: number[]): void {
  let missing: string | null = null;
  for (const field of fields) {
    if (!isIn(field, firmware) || isTooNew(field, firmware)) continue;
    const value = values[field.name] ?? field.default;
    if (value === undefined) {
      missing ??= field.name;
      continue;
    }
    if (missing !== null) throw new RangeError(`${missing} must be set, because ${field.name} behind it is`);
    encode(field.codec, value, { values, firmware, name: field.name }, out);
  }
}

interface Context {
  readonly values: MspFields;
  readonly firmware: Firmware;
  readonly name: string;
}

function encode(codec: CodecFacts, value: MspValue, context: Context, out: number[]): void {
  switch (codec.kind) {
    case 'variant':
      return encode(codec[context.firmware.variant], value, context, out);
    case 'record':
      return encodeFields(codec.fields, value as MspFields, context.firmware, out);
    case 'items': {
      const items = value as readonly MspValue[];
      if (codec.counted) out.push(items.length);
      return items.forEach((item) => encode(codec.item, item, context, out));
    }
    case 'text':
      return pushText(String(value), codec.length, codec.fill, out);
    case 'prefixed': {
      const length = codec.length > 0 ? codec.length : encoder.encode(String(value)).length;
      out.push(length);
      return pushText(String(value), length, codec.fill, out);
    }
    case 'rest':
      return void out.push(...encoder.encode(String(value)));
    case 'names':
      return (value as readonly string[]).forEach((name) => out.push(...encoder.encode(`${name};`)));
    case 'bytes':
      return void out.push(...(value as readonly number[]));
    case 'counted':
      return void out.push((value as readonly number[]).length, ...(value as readonly number[]));
    default:
      return encodeNumber(codec, Number(value), context.name, out);
  }
}

function pushText(text: string, length: number, fill: string, out: number[]): void {
  const bytes = encoder.encode(text);
  if (bytes.length > length) throw new RangeError(`${text} is longer than ${length} bytes`);
  out.push(...bytes, ...new Array<number>(length - bytes.length).fill(fill.charCodeAt(0)));
}

function encodeNumber(facts: NumberFacts, value: number, name: string, out: number[]): void {
  const [low, high] = limitsOf(facts);
  if (!(value >= low && value <= high)) throw new RangeError(`${name} must be ${low} to ${high}, got ${value}`);
  const { kind, perUnit = 1, step = 1, offset = 0 } = facts;
  const raw = Math.round((value * perUnit - offset) / step);
  for (let index = 0; index < SIZES[kind]; index += 1) out.push(Math.floor(raw / 2 ** (8 * index)) & 0xff);
}

/** Returns the smallest and the largest value of a number, in the unit of the field. */
export function limitsOf({ kind, perUnit = 1, step = 1, offset = 0 }: NumberFacts): readonly [number, number] {
  const bits = 8 * SIZES[kind];
  const [low, high] = kind.startsWith('i') ? [-(2 ** (bits - 1)), 2 ** (bits - 1) - 1] : [0, 2 ** bits - 1];
  return [(offset + low * step) / perUnit, (offset + high * step) / perUnit];
}
