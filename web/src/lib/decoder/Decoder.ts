/** Bytes → messages, by the classes that `mav gen typescript all` makes. */

import { HEADER_LENGTH_V1, HEADER_LENGTH_V2, MAGIC_V2, PacketBuilder, Parser, enums, messages } from '$generated';
import type { AnyMessageType, AnyPacket, Counters, FieldInfo, MessageInfo, RawPacket } from '$generated';

/** Bytes of one value of each type. */
export const SIZES: Readonly<Record<string, number>> = {
  char: 1,
  int8_t: 1,
  uint8_t: 1,
  int16_t: 2,
  uint16_t: 2,
  int32_t: 4,
  uint32_t: 4,
  float: 4,
  int64_t: 8,
  uint64_t: 8,
  double: 8,
};

/** Integers beyond 2^53 are `bigint`; `char[n]` is text, `uint8_t[n]` bytes. */
export type FieldValue = number | bigint | string | readonly (number | bigint)[] | Uint8Array;

/** A received message. */
export interface DecodedMessage {
  readonly system: number;
  readonly component: number;
  readonly sequence: number;
  /** Time of reception in ms since 1970. */
  readonly time: number;
  readonly id: number;
  /** Name in the definition, such as `ATTITUDE`; `UNKNOWN_54321` if the id is not known. */
  readonly name: string;
  /** Values by the names of the definition, read when they are asked for. */
  readonly fields: Readonly<Record<string, FieldValue>>;
  /** Bytes on the wire. */
  readonly length: number;
  /** The whole packet. */
  readonly bytes: Uint8Array;
}

/** Values for a message to send; numbers stand for 64-bit integers too, and bytes for a number with those bytes. */
export type SentFields = Readonly<Record<string, number | bigint | string | ArrayLike<number | bigint>>>;

class Received implements DecodedMessage {
  readonly time: number;
  private readonly packet: AnyPacket;
  private known: Readonly<Record<string, FieldValue>> | undefined;

  constructor(packet: AnyPacket, time: number) {
    this.packet = packet;
    this.time = time;
  }

  get system(): number {
    return this.packet.system;
  }

  get component(): number {
    return this.packet.component;
  }

  get sequence(): number {
    return this.packet.sequence;
  }

  get id(): number {
    return this.packet.id;
  }

  get name(): string {
    return this.packet.name;
  }

  get length(): number {
    return this.packet.length;
  }

  get bytes(): Uint8Array {
    return this.packet.bytes;
  }

  get fields(): Readonly<Record<string, FieldValue>> {
    this.known ??= fieldsOf(this.packet);
    return this.known;
  }
}

/** Parses the stream of one transport. */
export class Decoder {
  private readonly parser: Parser<(typeof messages)[number]>;
  private readonly unknown: RawPacket[] = [];

  constructor() {
    this.parser = new Parser(messages, { onUnknown: (packet) => this.unknown.push(packet) });
  }

  /** Totals so far: good packets, wrong checksums, unknown ids, skipped bytes. */
  get counters(): Readonly<Counters> {
    return this.parser.counters;
  }

  /**
   * Returns the messages that the next bytes complete.
   *
   * They are views of `data`, which must not be overwritten.
   */
  push(data: Uint8Array, time: number = Date.now()): DecodedMessage[] {
    const decoded: DecodedMessage[] = this.parser.push(data).map((packet) => new Received(packet, time));
    for (const packet of this.unknown.splice(0)) decoded.push(unknownMessage(packet, time));
    return decoded;
  }
}

/** Returns the bytes of a field that is no array, as they are on the wire. */
export function fieldBytes({ name, bytes }: DecodedMessage, field: string): Uint8Array {
  const info = messageInfo(name)?.fields.find((each) => each.name === field);
  if (info === undefined) throw new RangeError(`${name} has no field ${field}`);
  const start = bytes[0] === MAGIC_V2 ? HEADER_LENGTH_V2 : HEADER_LENGTH_V1;
  // Zeros at the end of a payload are not sent.
  const payload = bytes.subarray(start, start + bytes[1]!);
  const found = new Uint8Array(SIZES[info.type]!);
  found.set(payload.subarray(info.offset, info.offset + found.length));
  return found;
}

function unknownMessage(packet: RawPacket, time: number): DecodedMessage {
  const { system, component, sequence, id, length, bytes, payload } = packet;
  return { system, component, sequence, time, id, name: `UNKNOWN_${id}`, fields: { payload }, length, bytes };
}

function fieldsOf(packet: AnyPacket): Readonly<Record<string, FieldValue>> {
  const source = packet.fields as unknown as Readonly<Record<string, FieldValue>>;
  const fields: Record<string, FieldValue> = {};
  for (const { name, property } of packet.info.fields) fields[name] = narrowed(source[property]!);
  return fields;
}

/** Integers of 64 bits are numbers where a number holds them exactly. */
function narrowed(value: FieldValue): FieldValue {
  if (typeof value === 'bigint') {
    const number = Number(value);
    return Number.isSafeInteger(number) ? number : value;
  }
  return Array.isArray(value) && typeof value[0] === 'bigint' ? value.map((item) => narrowed(item) as number) : value;
}

const TYPES: ReadonlyMap<string, AnyMessageType> = new Map(
  messages.map((type) => [type.info.name, type as AnyMessageType]),
);

/** Names of all messages, sorted. */
export const messageNames: readonly string[] = [...TYPES.keys()].sort();

/** Returns the fields, units and enums of a message, or null if no definition has it. */
export function messageInfo(name: string): MessageInfo | null {
  return TYPES.get(name)?.info ?? null;
}

/** Returns the values of an enum by name, such as `MAV_TYPE`, or null. */
export function enumValues(name: string): Readonly<Record<string, number | bigint>> | null {
  return (enums as Readonly<Record<string, Readonly<Record<string, number | bigint>>>>)[name] ?? null;
}

/** Returns the name of an enum's value, such as `QUADROTOR`, or null. */
export function enumName(name: string, value: number | bigint): string | null {
  const values = enumValues(name);
  const key = Object.keys(values ?? {}).find((each) => values![each] === value);
  return key === undefined ? null : officialName(key);
}

/** Returns the name of the definition for a name in code, where a digit cannot be the first: `3D_FIX` for `_3D_FIX`. */
export function officialName(name: string): string {
  return name.replace(/^_(?=\d)/, '');
}

/** Builds packets of one sender by names of the definitions. */
export class Encoder {
  readonly system: number;
  readonly component: number;
  private readonly builder: PacketBuilder;

  /**
   * Creates an encoder; 255/190 is the usual address of a ground station, `sequence` the number of the first packet.
   */
  constructor(system = 255, component = 190, sequence = 0) {
    this.system = system;
    this.component = component;
    this.builder = new PacketBuilder({ system, component, sequence });
  }

  /** Builds a packet; fields that are left out are zero. Throws if a message, field or value is not possible. */
  build(name: string, fields: SentFields = {}): Uint8Array {
    const type = TYPES.get(name);
    if (type === undefined) throw new RangeError(`no message is named ${name}`);
    const unknown = Object.keys(fields).find((key) => !type.info.fields.some((field) => field.name === key));
    if (unknown !== undefined) throw new RangeError(`${name} has no field ${unknown}`);
    const values: Record<string, unknown> = {};
    for (const field of type.info.fields) {
      // Left out, so that the generated class writes its own version.
      if (field.name === 'mavlink_version' && fields[field.name] === undefined) continue;
      values[field.property] = sentValue(field, fields[field.name]);
    }
    return this.builder.build(withBytes(type, fields), values as never);
  }
}

/** Returns a type that also writes the values of fields that are given as their bytes. */
function withBytes(type: AnyMessageType, values: SentFields): AnyMessageType {
  const raw = type.info.fields.filter(
    ({ name, arrayLength }) => arrayLength === 0 && values[name] instanceof Uint8Array,
  );
  if (raw.length === 0) return type;
  const write = (view: DataView, at: number, fields: never): void => {
    (type.write as typeof write)(view, at, fields);
    for (const { name, offset } of raw) {
      (values[name] as Uint8Array).forEach((byte, index) => view.setUint8(at + offset + index, byte));
    }
  };
  return { info: type.info, write } as unknown as AnyMessageType;
}

function sentValue(field: FieldInfo, value: SentFields[string] | undefined): unknown {
  const wide = field.type === 'int64_t' || field.type === 'uint64_t';
  if (field.type === 'char') return value ?? '';
  if (field.arrayLength > 0) {
    const items = Array.from((value ?? []) as ArrayLike<number | bigint>);
    return wide ? items.map(BigInt) : items.map(Number);
  }
  if (value instanceof Uint8Array) return wide ? 0n : 0;
  return wide ? BigInt((value ?? 0) as number) : Number(value ?? 0);
}
