/** One session of a sealed link that this end began: frames of 20 bytes more than their content, each accepted once. */

import { chacha20poly1305 } from '@noble/ciphers/chacha.js';

import { joined, nonceOf, type SessionKeys } from './noise';

const HEADER_SIZE = 4;
export const OVERHEAD = 20;
/** Frames of another order that are accepted. */
const WINDOW = 1024;
const COUNTER_SIZE = 2 ** 28;
const FRAME_BITS = 0x80;
const INITIATOR_BITS = 0x40;

/** Whether a message is a frame, not a part of a handshake. */
export function isFrame(message: Uint8Array): boolean {
  return message.length >= OVERHEAD && (message[0]! & FRAME_BITS) !== 0;
}

export class Session {
  sent = 0;
  private top = -1;
  private readonly seen = new Set<number>();

  constructor(
    private readonly keys: SessionKeys,
    readonly epoch: number,
    /** When it began, in ms. */
    readonly started: number,
  ) {}

  get isConfirmed(): boolean {
    return this.top >= 0;
  }

  seal(content: Uint8Array): Uint8Array {
    const counter = this.sent;
    this.sent += 1;
    const header = new Uint8Array(HEADER_SIZE);
    new DataView(header.buffer).setUint32(0, counter % COUNTER_SIZE);
    header[0]! |= FRAME_BITS | INITIATOR_BITS | (this.epoch << 4);
    return joined(header, chacha20poly1305(this.keys.sending, nonceOf(counter), header).encrypt(content));
  }

  /** Returns the content of a frame; null if it is forged, of another session, or was received before. */
  open(frame: Uint8Array): Uint8Array | null {
    const first = frame[0]!;
    if ((first & INITIATOR_BITS) !== 0 || ((first >> 4) & 3) !== this.epoch) return null;
    const header = frame.slice(0, HEADER_SIZE);
    const low = new DataView(header.buffer).getUint32(0) % COUNTER_SIZE;
    const counter = this.complete(low);
    if (counter <= this.top - WINDOW || this.seen.has(counter)) return null;
    let content: Uint8Array;
    try {
      content = chacha20poly1305(this.keys.receiving, nonceOf(counter), header).decrypt(frame.subarray(HEADER_SIZE));
    } catch {
      return null;
    }
    this.accept(counter);
    return content;
  }

  private accept(counter: number): void {
    this.seen.add(counter);
    const before = this.top;
    this.top = Math.max(before, counter);
    const oldest = this.top - WINDOW;
    if (this.seen.size > 2 * WINDOW) for (const each of this.seen) if (each <= oldest) this.seen.delete(each);
  }

  /** Returns the counter with these low bits that is nearest to the highest accepted one. */
  private complete(low: number): number {
    const top = Math.max(this.top, 0);
    const counter = top - (top % COUNTER_SIZE) + low;
    if (counter - top > COUNTER_SIZE / 2 && counter >= COUNTER_SIZE) return counter - COUNTER_SIZE;
    return top - counter > COUNTER_SIZE / 2 ? counter + COUNTER_SIZE : counter;
  }
}
