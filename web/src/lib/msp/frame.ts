/** Frames of MSP: v1, jumbo, v2, and v2 over v1, as `mavstack.msp.frame` describes them. */

export type FrameVersion = 'V1' | 'JUMBO' | 'V2' | 'V2_OVER_V1';
export type Direction = '<' | '>' | '!';

export interface Frame {
  readonly command: number;
  readonly payload: Uint8Array;
  readonly direction: Direction;
}

export const MAX_PAYLOAD = 4096;
const MAX_V1_COMMAND = 254;
const WRAPPED = 255;
const JUMBO_SIZE = 255;
const V2_HEADER = 5;
const START = 0x24;
const LETTERS = { M: 0x4d, X: 0x58 } as const;

/** Returns the bytes of a frame; v2 where v1 cannot have the command or the payload, which firmwares want. */
export function encodeFrame(
  command: number,
  payload: Uint8Array = new Uint8Array(),
  version: FrameVersion = command > MAX_V1_COMMAND || payload.length >= JUMBO_SIZE ? 'V2' : 'V1',
  direction: Direction = '<',
): Uint8Array {
  if (version === 'V2') {
    const body = v2Body(command, payload);
    return Uint8Array.of(START, LETTERS.X, direction.charCodeAt(0), ...body, crc8(body));
  }
  if (version === 'V2_OVER_V1') {
    const body = v2Body(command, payload);
    return v1Frame(WRAPPED, [...body, crc8(body)], direction, false);
  }
  return v1Frame(command, [...payload], direction, version === 'JUMBO');
}

function v1Frame(command: number, payload: readonly number[], direction: Direction, isJumbo: boolean): Uint8Array {
  const { length } = payload;
  const head = length < JUMBO_SIZE && !isJumbo ? [length, command] : [JUMBO_SIZE, command, length & 0xff, length >> 8];
  const body = [...head, ...payload];
  return Uint8Array.of(START, LETTERS.M, direction.charCodeAt(0), ...body, xor8(body));
}

function v2Body(command: number, payload: Uint8Array): number[] {
  const { length } = payload;
  return [0, command & 0xff, command >> 8, length & 0xff, length >> 8, ...payload];
}

export function xor8(data: ArrayLike<number>): number {
  let sum = 0;
  for (let index = 0; index < data.length; index += 1) sum ^= data[index]!;
  return sum;
}

/** CRC-8/DVB-S2. */
export function crc8(data: ArrayLike<number>): number {
  let crc = 0;
  for (let index = 0; index < data.length; index += 1) {
    crc ^= data[index]!;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 0x80 ? ((crc << 1) ^ 0xd5) & 0xff : (crc << 1) & 0xff;
  }
  return crc;
}

interface Layout {
  readonly command: number;
  /** Bytes before the payload, and of the payload. */
  readonly header: number;
  readonly size: number;
  readonly isV2: boolean;
}

/** Finds frames in a stream of bytes; bytes that are not part of one are dropped and counted. */
export class FrameReader {
  dropped = 0;
  private buffer: number[] = [];

  feed(data: Uint8Array): Frame[] {
    this.buffer.push(...data);
    const frames: Frame[] = [];
    for (;;) {
      const start = this.buffer.indexOf(START);
      const skipped = start < 0 ? this.buffer.length : start;
      this.dropped += skipped;
      this.buffer = this.buffer.slice(skipped);
      const layout = layoutOf(this.buffer);
      if (layout === null || this.buffer.length === 0) return frames;
      if (layout === 'invalid') {
        this.drop(1);
        continue;
      }
      const end = layout.header + layout.size + 1;
      if (this.buffer.length < end) return frames;
      const frame = frameOf(this.buffer.slice(0, end), layout);
      if (frame === null) this.drop(1);
      else {
        frames.push(frame);
        this.buffer = this.buffer.slice(end);
      }
    }
  }

  private drop(count: number): void {
    this.dropped += count;
    this.buffer = this.buffer.slice(count);
  }
}

/** Returns the layout of the frame at the beginning; null: more bytes are needed. */
function layoutOf(bytes: readonly number[]): Layout | 'invalid' | null {
  const [, letter, direction] = bytes;
  if (letter === undefined) return null;
  if (letter !== LETTERS.M && letter !== LETTERS.X) return 'invalid';
  if (direction === undefined) return null;
  if (!'<>!'.includes(String.fromCharCode(direction))) return 'invalid';
  const layout = letter === LETTERS.X ? v2Layout(bytes) : v1Layout(bytes);
  return layout !== null && layout.size > MAX_PAYLOAD ? 'invalid' : layout;
}

function v2Layout(bytes: readonly number[]): Layout | null {
  if (bytes.length < 3 + V2_HEADER) return null;
  return { command: word(bytes, 4), header: 3 + V2_HEADER, size: word(bytes, 6), isV2: true };
}

function v1Layout(bytes: readonly number[]): Layout | null {
  if (bytes.length < 5) return null;
  const [size, command] = [bytes[3]!, bytes[4]!];
  if (size < JUMBO_SIZE) return { command, header: 5, size, isV2: false };
  return bytes.length < 7 ? null : { command, header: 7, size: word(bytes, 5), isV2: false };
}

const word = (bytes: readonly number[], at: number): number => bytes[at]! | (bytes[at + 1]! << 8);

function frameOf(bytes: readonly number[], { command, header, size, isV2 }: Layout): Frame | null {
  const body = bytes.slice(3, header + size);
  if (bytes.at(-1) !== (isV2 ? crc8(body) : xor8(body))) return null;
  const direction = String.fromCharCode(bytes[2]!) as Direction;
  const payload = Uint8Array.from(bytes.slice(header, header + size));
  if (isV2 || command !== WRAPPED) return { command, payload, direction };
  const inner = payload.subarray(0, -1);
  const length = payload.length > V2_HEADER ? payload[3]! | (payload[4]! << 8) : -1;
  if (length !== inner.length - V2_HEADER || crc8(inner) !== payload.at(-1)) return null;
  return { command: payload[1]! | (payload[2]! << 8), payload: inner.slice(V2_HEADER), direction };
}
