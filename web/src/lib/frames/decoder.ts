/**
 * Decoders of frames, declared as data: how a stream of bytes is cut into frames, and which values they hold.
 *
 * The station reads the same declarations (`server/rows/frame_decoder.py`, whose head shows one);
 * `decoder-cases.json` tests both. A decoder without messages leaves the bytes of its frames to scripts.
 */
import { CHECKSUMS, type ChecksumKind } from './checksums';
import {
  type Endian,
  type FrameField,
  indexOf,
  isInside,
  type NumberName,
  type NumberPlace,
  NUMBERS,
  readField,
  readNumber,
  type Value,
} from './fields';
import { type Framer, makeFramer, MAX_DATAGRAM, MAX_FRAME } from './framing';
import { DecoderError, Members, refuse } from './members';

export const FILE_TYPE = 'mavstack-decoder';
const FRAME_MESSAGE = 'FRAME';
const DEFAULT_MESSAGE = 'ROW';
const MAX_MESSAGES = 64;
const MAX_FIELDS = 128;
const MAX_COUNT = 256;
const MAX_MARKER = 16;
const MAX_NAMES = 256;
const MAX_UNIT = 16;
const MAX_ADD = 1 << 16;
const ENDIANS = ['little', 'big'] as const;
const KINDS = ['datagram', 'delimiter', 'cobs', 'fixed', 'length'] as const;
const UNSIGNED = ['uint8', 'uint16', 'uint24', 'uint32'] as const;
const NUMBER_NAMES = Object.keys(NUMBERS) as NumberName[];

export interface Framing {
  readonly kind: (typeof KINDS)[number];
  /** The bytes that begin a frame, or the delimiter that ends it. */
  readonly marker: Uint8Array;
  /** The bytes of a frame of fixed size. */
  readonly size: number;
  readonly length: NumberPlace | null;
  /** Length plus this is the size of the frame, with its marker and checksum. */
  readonly add: number;
  /** The bytes up to the end of the marker and of the length. */
  readonly header: number;
}

interface Checksum {
  readonly kind: ChecksumKind;
  readonly place: NumberPlace;
  readonly start: number;
  readonly end: number | null;
}

export interface FrameMessage {
  readonly name: string;
  readonly id: number | null;
  readonly size: number | null;
  readonly fields: readonly FrameField[];
}

export interface FrameDecoder {
  readonly name: string;
  readonly framing: Framing;
  readonly checksum: Checksum | null;
  readonly id: NumberPlace | null;
  readonly messages: readonly FrameMessage[];
}

/** The values of a frame; `data` are the bytes of a frame that a script reads. */
export interface FrameRow {
  readonly message: string;
  readonly fields: Readonly<Record<string, Value>>;
  readonly data?: Uint8Array;
}

const DATAGRAMS: Framing = { kind: 'datagram', marker: new Uint8Array(), size: 0, length: null, add: 0, header: 0 };

/** Reads the rows of one stream; without a decoder each chunk is a frame, whose bytes are left to scripts. */
export class FrameReader {
  private readonly framer: Framer;
  private unread = 0;

  constructor(private readonly decoder: FrameDecoder | null) {
    const checksum = decoder?.checksum ?? null;
    this.framer = makeFramer(decoder?.framing ?? DATAGRAMS, (frame) => checksum === null || fits(checksum, frame));
  }

  /** Frames that were wrong or too long, and those that no message fits. */
  get refused(): number {
    return this.framer.refused + this.unread;
  }

  feed(data: Uint8Array): FrameRow[] {
    const rows: FrameRow[] = [];
    for (const frame of this.framer.feed(data)) {
      const row = this.decoder === null ? frameRow(frame) : readFrame(this.decoder, frame);
      if (row === null) this.unread++;
      else rows.push(row);
    }
    return rows;
  }
}

/** Returns the row of a frame, null if no message fits. */
export function readFrame(decoder: FrameDecoder, frame: Uint8Array): FrameRow | null {
  if (decoder.messages.length === 0) return frameRow(frame);
  const number =
    decoder.id !== null && isInside(decoder.id, decoder.id.type.size, frame.length)
      ? Number(readNumber(decoder.id, frame))
      : null;
  for (const { name, id, size, fields } of decoder.messages) {
    if ((id !== null && id !== number) || (size !== null && size !== frame.length)) continue;
    if (!fields.every((field) => hasField(field, frame.length, decoder.checksum))) continue;
    const values = fields.map((field) => [field.name, readField(field, frame)] as const);
    return {
      message: name,
      fields: Object.fromEntries(values.filter(([, value]) => value !== null)) as FrameRow['fields'],
    };
  }
  return null;
}

function frameRow(frame: Uint8Array): FrameRow {
  return { message: FRAME_MESSAGE, fields: { size: frame.length }, data: frame };
}

/** Returns whether a frame has a value: before its checksum, unless it is counted from the end. */
function hasField({ place, size }: FrameField, length: number, checksum: Checksum | null): boolean {
  const isBefore = place.offset >= 0 && checksum !== null && checksum.place.offset < 0;
  return isInside(place, size, isBefore ? length + checksum.place.offset : length);
}

function fits({ kind, place, start, end }: Checksum, frame: Uint8Array): boolean {
  const at = indexOf(place.offset, frame.length);
  const last = end === null ? at : indexOf(end, frame.length);
  if (!isInside(place, place.type.size, frame.length) || last < start || last > frame.length) return false;
  return CHECKSUMS[kind].of(frame.subarray(start, last)) === Number(readNumber(place, frame));
}

/** Returns the decoder of a text; throws a DecoderError that names the place and the reason. */
export function readDecoder(text: string): FrameDecoder {
  try {
    return parseDecoder(JSON.parse(text));
  } catch (error) {
    if (error instanceof DecoderError) throw error;
    throw new DecoderError(`it is not JSON: ${(error as Error).message}`);
  }
}

/** Returns the decoder of a declaration; throws a DecoderError that names the place and the reason. */
export function parseDecoder(value: unknown): FrameDecoder {
  const members = new Members(value);
  members.choice('type', [FILE_TYPE], FILE_TYPE);
  members.integer('version', 1, 1, 1);
  const name = members.name('name', 'decoder');
  const endian = members.choice('endian', ENDIANS, 'little');
  const framing = members.has('framing') ? parseFraming(members.child('framing'), endian) : DATAGRAMS;
  const checksum = members.has('checksum') ? parseChecksum(members.child('checksum'), endian, framing) : null;
  const id = members.has('id') ? parsePlace(members.child('id'), endian, UNSIGNED) : null;
  const first = Math.max(framing.header, id !== null && id.offset >= 0 ? id.offset + id.type.size : 0);
  const messages = members
    .children('messages', MAX_MESSAGES)
    .map((each) => parseMessage(each, endian, first, { framing, checksum }));
  members.end();
  checkMessages(messages, id);
  return { name, framing, checksum, id, messages };
}

function parseFraming(members: Members, endian: Endian): Framing {
  const kind = members.choice('kind', KINDS);
  let marker = new Uint8Array(kind === 'cobs' ? 1 : 0) as Uint8Array;
  let [size, add] = [0, 0];
  let length: NumberPlace | null = null;
  if (kind === 'delimiter') marker = members.hexBytes('delimiter', 1, MAX_MARKER);
  else if (kind === 'fixed' || kind === 'length') marker = members.hexBytes('marker', 0, MAX_MARKER, '');
  if (kind === 'fixed') size = members.integer('size', Math.max(marker.length, 1), MAX_FRAME);
  else if (kind === 'length') {
    length = parsePlace(members.child('length'), endian, UNSIGNED, 0);
    add = members.integer('add', -MAX_ADD, MAX_ADD, 0);
  }
  members.end();
  const lengthEnd = length === null ? 0 : length.offset + length.type.size;
  const header = kind === 'fixed' || kind === 'length' ? Math.max(marker.length, lengthEnd) : 0;
  return { kind, marker, size, length, add, header };
}

function parsePlace(
  members: Members,
  endian: Endian,
  types: readonly NumberName[],
  minimum = -MAX_DATAGRAM,
): NumberPlace {
  const offset = members.integer('offset', minimum, MAX_DATAGRAM);
  const type = NUMBERS[members.choice('type', types)];
  const place = { offset, type, endian: members.choice('endian', ENDIANS, endian) };
  members.end();
  return place;
}

function parseChecksum(members: Members, endian: Endian, framing: Framing): Checksum {
  const kind = members.choice('kind', Object.keys(CHECKSUMS) as ChecksumKind[]);
  const { size } = CHECKSUMS[kind];
  const offset = members.integer('offset', -MAX_DATAGRAM, MAX_DATAGRAM, -size);
  const start = members.integer('start', 0, MAX_DATAGRAM, 0);
  const end = members.has('end') ? members.integer('end', -MAX_DATAGRAM, MAX_DATAGRAM) : null;
  const type = { size, kind: 'unsigned' } as const;
  const place = { offset, type, endian: members.choice('endian', ENDIANS, endian) };
  members.end();
  if (framing.size > 0 && !isInside(place, size, framing.size))
    refuse(members.placeOf('offset'), `must be inside the ${framing.size} bytes of a frame`, offset);
  return { kind, place, start, end };
}

function parseMessage(
  members: Members,
  endian: Endian,
  first: number,
  { framing, checksum }: Pick<FrameDecoder, 'framing' | 'checksum'>,
): FrameMessage {
  const name = members.name('name', DEFAULT_MESSAGE);
  const id = members.has('id') ? members.integer('id', 0, 2 ** 32 - 1) : null;
  const size = members.has('size') ? members.integer('size', 1, MAX_DATAGRAM) : null;
  const length = size ?? framing.size;
  const fields: FrameField[] = [];
  let offset = first;
  for (const each of members.children('fields', MAX_FIELDS)) {
    const field = parseField(each, endian, offset);
    if (fields.some((other) => other.name === field.name))
      refuse(each.placeOf('name'), 'is the name of another field', field.name);
    if (length > 0 && !hasField(field, length, checksum))
      refuse(
        each.placeOf('offset'),
        `must be inside the ${length} bytes of a frame, before its checksum`,
        field.place.offset,
      );
    fields.push(field);
    offset = field.place.offset + field.size;
  }
  members.end();
  if (fields.length === 0) refuse(members.placeOf('fields'), 'must have at least one field');
  return { name, id, size, fields };
}

function parseField(members: Members, endian: Endian, at: number): FrameField {
  const name = members.name('name');
  const kind = members.choice('type', [...NUMBER_NAMES, 'text'] as const);
  const offset = members.integer('offset', -MAX_DATAGRAM, MAX_DATAGRAM, at);
  const plain = { name, count: 0, isText: false, bits: null, factor: 1, add: 0, unit: '', names: {} };
  if (kind === 'text') {
    const size = members.integer('size', 1, MAX_FRAME);
    members.end();
    return { ...plain, place: { offset, type: NUMBERS.uint8, endian }, size, isText: true };
  }
  const type = NUMBERS[kind];
  const place = { offset, type, endian: members.choice('endian', ENDIANS, endian) };
  const count = members.has('count') ? members.integer('count', 1, MAX_COUNT) : 0;
  const factor = members.number('factor', 1);
  const add = members.number('add', 0);
  const unit = members.text('unit', MAX_UNIT, '');
  const isInteger = type.kind !== 'float' && count === 0;
  const bits = isInteger && members.has('bits') ? parseBits(members.child('bits'), type.size * 8) : null;
  const names = isInteger ? members.texts('names', MAX_NAMES) : {};
  members.end();
  return { ...plain, place, size: type.size * Math.max(count, 1), count, bits, factor, add, unit, names };
}

function parseBits(members: Members, width: number): { first: number; count: number } {
  const first = members.integer('first', 0, width - 1);
  const count = members.integer('count', 1, width - first);
  members.end();
  return { first, count };
}

function checkMessages(messages: readonly FrameMessage[], id: NumberPlace | null): void {
  messages.forEach((message, index) => {
    const place = `messages[${index}]`;
    const others = messages.slice(0, index);
    if (message.id !== null && id === null)
      refuse(`${place}.id`, 'needs "id" in the decoder, which says where the number is');
    if (others.some(({ name }) => name === message.name))
      refuse(`${place}.name`, 'is the name of another message', message.name);
    if (others.some((each) => each.id === message.id && each.size === message.size))
      refuse(place, 'has the id and the size of another message');
  });
}
