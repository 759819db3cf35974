/** A recorded flight (.tlog) as a link, with time, speed and seek. */

import { BaseTransport } from './Transport';

/** A record: 8 bytes of time in µs since 1970, big endian, and a packet. */
interface LogRecord {
  readonly time: number;
  readonly start: number;
  readonly end: number;
}

const TIME_LENGTH = 8;
const TICK = 50;

export class ReplayTransport extends BaseTransport {
  readonly name: string;
  private readonly data: Uint8Array;
  private readonly records: readonly LogRecord[];
  private index = 0;
  private timer: ReturnType<typeof setInterval> | null = null;
  private at = 0;
  private last = 0;
  /** Seconds of the recording per second. */
  speed = 1;

  constructor(data: Uint8Array, name = 'recording') {
    super();
    this.name = name;
    this.data = data;
    this.records = recordsOf(data);
    this.at = this.start;
  }

  /** Time of the first packet in ms since 1970; 0 for an empty recording. */
  get start(): number {
    return this.records[0]?.time ?? 0;
  }

  get end(): number {
    return this.records.at(-1)?.time ?? 0;
  }

  /** Returns the time of the recording that is shown. */
  override now(): number {
    return this.at;
  }

  get packets(): number {
    return this.records.length;
  }

  get paused(): boolean {
    return this.timer === null;
  }

  async open(): Promise<void> {
    if (this.records.length === 0) {
      this.change('failed', 'the file has no packets');
      throw new Error('the file has no packets');
    }
    this.change('open');
    this.play();
  }

  close(): void {
    this.pause();
    this.change('closed');
  }

  send(_packets: Uint8Array): void {
    // It has no receiver: the flight is over.
  }

  play(): void {
    if (this.timer !== null) return;
    this.last = Date.now();
    this.timer = setInterval(() => {
      const now = Date.now();
      this.advance((now - this.last) * this.speed);
      this.last = now;
    }, TICK);
  }

  pause(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }

  /** Goes to a time of the recording; the packets of the minute before it give the state at that time. */
  seek(time: number): void {
    this.at = Math.min(Math.max(time, this.start), this.end);
    this.index = this.indexAt(this.at - 60_000);
    this.advance(0);
  }

  /** Emits the packets of the next ms of the recording. */
  advance(elapsed: number): void {
    this.at = Math.min(this.at + elapsed, this.end);
    while (this.index < this.records.length && this.records[this.index]!.time <= this.at) {
      const { start, end, time } = this.records[this.index]!;
      this.index += 1;
      this.emit(this.data.subarray(start, end), time);
    }
    if (this.index >= this.records.length) this.pause();
  }

  private indexAt(time: number): number {
    let [low, high] = [0, this.records.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.records[middle]!.time < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Finds the records of a .tlog; bytes that are none are skipped. */
export function recordsOf(data: Uint8Array): LogRecord[] {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const records: LogRecord[] = [];
  let at = 0;
  while (at + TIME_LENGTH + 8 <= data.length) {
    const length = packetLength(data, at + TIME_LENGTH);
    const time = Number(view.getBigUint64(at)) / 1000;
    const start = at + TIME_LENGTH;
    if (length === 0 || start + length > data.length || time < 1e11 || time > 1e13) {
      at += 1;
      continue;
    }
    records.push({ time, start, end: start + length });
    at = start + length;
  }
  return records;
}

/** Returns the length of the packet that begins at an index, or 0. */
function packetLength(data: Uint8Array, at: number): number {
  const payload = data[at + 1] ?? 0;
  if (data[at] === 0xfe) return payload + 8;
  return data[at] === 0xfd ? payload + 12 + ((data[at + 2]! & 1) !== 0 ? 13 : 0) : 0;
}
