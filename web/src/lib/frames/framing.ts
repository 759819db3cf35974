/**
 * Frames in a stream of bytes: between delimiters, or with a marker, a length and a checksum.
 *
 * Each class is fed with bytes as they come, and returns the frames that they complete, as the station does
 * (`server/rows/framing.py`). Which frames it finds does not depend on where the bytes are cut.
 */
import type { Framing } from './decoder';
import { readNumber } from './fields';

/** Bytes of a frame in a stream, and of a datagram. */
export const MAX_FRAME = 4096;
export const MAX_DATAGRAM = 65_535;
/** Bytes that may be checked without a result, and bytes that are checked again for each byte of the stream. */
const CREDIT = 4 * MAX_FRAME;
const EARNED = 4;

export type Fits = (frame: Uint8Array) => boolean;

export interface Framer {
  /** Frames that were too long or wrong. */
  refused: number;
  feed(data: Uint8Array): Uint8Array[];
}

class DatagramFramer implements Framer {
  refused = 0;
  constructor(private readonly fits: Fits) {}

  feed(data: Uint8Array): Uint8Array[] {
    if (data.length <= MAX_DATAGRAM && this.fits(data)) return [data];
    this.refused++;
    return [];
  }
}

/** Frames end with a delimiter, which is not part of them; empty ones are ignored. */
class DelimiterFramer implements Framer {
  refused = 0;
  private pending = new Uint8Array();
  private isTooLong = false;

  constructor(
    private readonly delimiter: Uint8Array,
    private readonly fits: Fits,
    private readonly decode: (frame: Uint8Array) => Uint8Array | null,
  ) {}

  feed(data: Uint8Array): Uint8Array[] {
    const bytes = joined(this.pending, data);
    const frames: Uint8Array[] = [];
    let start = 0;
    for (let end = find(bytes, this.delimiter, 0); end >= 0; end = find(bytes, this.delimiter, start)) {
      const frame = this.end(bytes.slice(start, end));
      if (frame !== null) frames.push(frame);
      start = end + this.delimiter.length;
    }
    this.pending = bytes.slice(start);
    if (this.pending.length > MAX_FRAME + this.delimiter.length) {
      this.pending = this.pending.slice(this.pending.length - this.delimiter.length + 1);
      this.isTooLong = true;
    }
    return frames;
  }

  private end(frame: Uint8Array): Uint8Array | null {
    const isTooLong = this.isTooLong || frame.length > MAX_FRAME;
    this.isTooLong = false;
    if (frame.length === 0 && !isTooLong) return null;
    const decoded = isTooLong ? null : this.decode(frame);
    if (decoded !== null && this.fits(decoded)) return decoded;
    this.refused++;
    return null;
  }
}

/**
 * Frames have a fixed size or a field with it, usually after a marker.
 *
 * After a wrong checksum the search continues at the next byte, since the marker may have been a value. A stream that
 * is made of such markers would cost a check for each byte: then whole frames are left out.
 */
class SizedFramer implements Framer {
  refused = 0;
  private pending = new Uint8Array();
  /** The first byte of `pending` that is not taken. */
  private at = 0;
  private credit = CREDIT;

  constructor(
    private readonly framing: Framing,
    private readonly fits: Fits,
  ) {}

  feed(data: Uint8Array): Uint8Array[] {
    this.pending = joined(this.pending, data);
    const frames: Uint8Array[] = [];
    while (this.findMarker()) {
      const size = this.size();
      if (size === null) break;
      if (size < Math.max(this.framing.header, 1) || size > MAX_FRAME) {
        this.skip(1);
        continue;
      }
      const frame = this.pending.slice(this.at, this.at + size);
      if (frame.length < size) break;
      if (this.fits(frame)) {
        frames.push(frame);
        this.advance(size);
      } else {
        this.credit -= size;
        this.skip(this.credit >= 0 ? 1 : size);
      }
    }
    this.pending = this.pending.slice(this.at);
    this.at = 0;
    return frames;
  }

  /** Advances to the next marker; returns whether there is one. */
  private findMarker(): boolean {
    const { marker } = this.framing;
    const found = find(this.pending, marker, this.at);
    if (found >= 0) {
      this.advance(found - this.at);
      return this.at < this.pending.length;
    }
    // The last bytes may begin a marker.
    this.advance(Math.max(this.pending.length - marker.length + 1 - this.at, 0));
    return false;
  }

  /** Returns the size of the frame that begins here; null: its length has not come yet. */
  private size(): number | null {
    const { length, header, size, add } = this.framing;
    if (length === null) return size;
    const start = this.pending.slice(this.at, this.at + header);
    return start.length === header ? Number(readNumber(length, start)) + add : null;
  }

  private skip(count: number): void {
    this.refused++;
    this.advance(count);
  }

  private advance(count: number): void {
    this.at += count;
    this.credit = Math.min(CREDIT, this.credit + EARNED * count);
  }
}

/** Returns the framer of a stream. */
export function makeFramer(framing: Framing, fits: Fits): Framer {
  if (framing.kind === 'datagram') return new DatagramFramer(fits);
  if (framing.kind === 'delimiter') return new DelimiterFramer(framing.marker, fits, (frame) => frame);
  if (framing.kind === 'cobs') return new DelimiterFramer(framing.marker, fits, decodeCobs);
  return new SizedFramer(framing, fits);
}

/** Returns the bytes that COBS (consistent overhead byte stuffing) encodes; null if they are malformed. */
export function decodeCobs(data: Uint8Array): Uint8Array | null {
  const found: number[] = [];
  for (let at = 0; at < data.length; ) {
    const code = data[at]!;
    const block = data.slice(at + 1, at + code);
    if (code === 0 || block.length !== code - 1 || block.includes(0)) return null;
    found.push(...block);
    at += code;
    // No zero byte follows a block of maximum length.
    if (code < 0xff && at < data.length) found.push(0);
  }
  return Uint8Array.from(found);
}

function joined(one: Uint8Array, other: Uint8Array): Uint8Array<ArrayBuffer> {
  const all = new Uint8Array(one.length + other.length);
  all.set(one);
  all.set(other, one.length);
  return all;
}

function find(data: Uint8Array, wanted: Uint8Array, from: number): number {
  if (wanted.length === 0) return from;
  for (let at = data.indexOf(wanted[0]!, from); at >= 0; at = data.indexOf(wanted[0]!, at + 1)) {
    if (wanted.every((byte, index) => data[at + index] === byte)) return at;
  }
  return -1;
}
