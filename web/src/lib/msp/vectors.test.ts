/** The vectors of MSP that Python's tables write (`conformance/msp.jsonl`). */

import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { describe, expect, it } from 'vitest';

import { decodeMessage, encodeMessage, type MspFields } from './codec';
import { FACTS, type Firmware } from './facts';
import { encodeFrame, FrameReader, type Direction, type FrameVersion } from './frame';

interface FrameVector {
  readonly frame: FrameVersion;
  readonly direction: Direction;
  readonly command: number;
  readonly payload: string;
  readonly bytes: string;
}
interface MessageVector {
  readonly message: string;
  readonly firmware: Firmware['variant'];
  readonly api: string;
  readonly payload: string;
  readonly fields: MspFields;
}

const path = join(import.meta.dirname, '../../../../conformance/msp.jsonl');
const lines = readFileSync(path, 'ascii').trim().split('\n');
const vectors = lines.map((line) => JSON.parse(line) as FrameVector | MessageVector);
const frames = vectors.filter((each): each is FrameVector => 'frame' in each);
const messages = vectors.filter((each): each is MessageVector => 'message' in each);
const bytes = (hex: string): Uint8Array => Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));
const hex = (data: Uint8Array): string => Buffer.from(data).toString('hex');

describe('frames of MSP', () => {
  it('have the bytes of the vectors', () => {
    for (const { frame, direction, command, payload, bytes: expected } of frames) {
      expect(hex(encodeFrame(command, bytes(payload), frame, direction))).toBe(expected);
    }
  });

  it('are found in a stream of any chunks, with junk between them', () => {
    const stream = bytes(frames.map((each) => `0024004d${each.bytes}`).join(''));
    for (const size of [1, 7, 1000, stream.length]) {
      const reader = new FrameReader();
      const found = [];
      for (let at = 0; at < stream.length; at += size) found.push(...reader.feed(stream.slice(at, at + size)));
      expect(found.map(({ command, payload }) => [command, hex(payload)])).toEqual(
        frames.map(({ command, payload }) => [command, payload]),
      );
      expect(reader.dropped).toBe(4 * frames.length);
    }
  });

  it('with a wrong checksum are dropped', () => {
    const damaged = bytes(frames[10]!.bytes);
    damaged[damaged.length - 1]! ^= 1;
    expect(new FrameReader().feed(damaged)).toEqual([]);
  });
});

describe('messages of MSP', () => {
  const known = Object.keys(FACTS.messages);

  it('are all in the vectors', () => {
    expect(known.filter((name) => !messages.some(({ message }) => message === name))).toEqual([]);
  });

  it.each(known)('%s has the fields and the payload of the vectors', (name) => {
    for (const { message, firmware, api, payload, fields } of messages) {
      if (message !== name) continue;
      const [major = 0, minor = 0] = api.split('.').map(Number);
      const info: Firmware = { variant: firmware, api: [major, minor] };
      expect(decodeMessage(name, bytes(payload), info)).toEqual(fields);
      expect(hex(encodeMessage(name, fields, info))).toBe(payload);
    }
  });
});
