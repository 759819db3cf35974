/**
 * The conformance corpus: the decoder finds the same packets with the same values as the core, and builds the same
 * bytes.
 */

import { readFileSync } from 'node:fs';

import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, messageInfo, SIZES, type DecodedMessage, type FieldValue } from './Decoder';

interface Expected {
  readonly message: string;
  readonly version: number;
  readonly sequence: number;
  readonly system: number;
  readonly component: number;
  readonly signed: boolean;
  readonly fields: Readonly<Record<string, string>>;
  readonly packed: string;
}

interface Case {
  readonly name: string;
  readonly key: string | null;
  readonly input: string;
  readonly packets: readonly Expected[];
  readonly counters: { readonly good: number; readonly bad_crc: number; readonly unknown: number };
}

const CHUNK = 7;

const corpus = readFileSync(new URL('../../../../conformance/all.jsonl', import.meta.url), 'utf8')
  .split('\n')
  .filter((line) => line !== '')
  .map((line) => JSON.parse(line) as Case)
  // The page verifies no signatures: the station does.
  .filter(({ key }) => key === null);

function bytesOf(hex: string): Uint8Array {
  return Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));
}

function hexOf(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** Returns the bytes of a value on the wire, as the corpus has them. */
function wireHex(type: string, length: number, value: FieldValue): string {
  const size = SIZES[type]!;
  const view = new DataView(new ArrayBuffer(size * Math.max(length, 1)));
  if (typeof value === 'string') {
    new TextEncoder().encode(value).forEach((byte, index) => view.setUint8(index, byte));
    return hexOf(new Uint8Array(view.buffer));
  }
  const values = length > 0 ? Array.from(value as ArrayLike<number | bigint>) : [value as number];
  values.forEach((item, index) => {
    const at = index * size;
    if (type === 'float') view.setFloat32(at, Number(item), true);
    else if (type === 'double') view.setFloat64(at, Number(item), true);
    else if (size === 8) view.setBigUint64(at, BigInt.asUintN(64, BigInt(item)), true);
    else if (size === 4) view.setInt32(at, Number(item), true);
    else if (size === 2) view.setInt16(at, Number(item), true);
    else view.setInt8(at, Number(item));
  });
  return hexOf(new Uint8Array(view.buffer));
}

function shown(message: DecodedMessage): object {
  const { name, sequence, system, component } = message;
  const infos = messageInfo(name)?.fields ?? [];
  const fields = Object.fromEntries(
    infos.map((info) => [info.name, wireHex(info.type, info.arrayLength, message.fields[info.name]!)]),
  );
  return { message: name, sequence, system, component, fields };
}

/** Differences, one text each: a matcher for each packet would take seconds. */
function differences({ name, input, packets, counters }: Case): string[] {
  const decoder = new Decoder();
  const bytes = bytesOf(input);
  const found: DecodedMessage[] = [];
  for (let at = 0; at < bytes.length; at += CHUNK) found.push(...decoder.push(bytes.subarray(at, at + CHUNK)));
  const known = found.filter((message) => !message.name.startsWith('UNKNOWN_')).map(shown);
  const wanted = packets.map(({ message, sequence, system, component, fields }) => ({
    message,
    sequence,
    system,
    component,
    fields,
  }));
  const { good, badCrc, unknown } = decoder.counters;
  const result: string[] = [];
  if (JSON.stringify(known) !== JSON.stringify(wanted)) result.push(`${name}: packets`);
  if (good !== counters.good || badCrc !== counters.bad_crc || unknown !== counters.unknown)
    result.push(`${name}: counters`);
  return result;
}

describe('conformance corpus', () => {
  it('is decoded in chunks of seven bytes', () => {
    expect(corpus.length).toBeGreaterThan(300);
    expect(corpus.flatMap(differences)).toEqual([]);
  });

  it('is built again from the decoded fields', () => {
    const wrong: string[] = [];
    for (const { name, input, packets } of corpus) {
      const found = new Decoder().push(bytesOf(input)).filter((message) => !message.name.startsWith('UNKNOWN_'));
      packets.forEach(({ version, packed, sequence, system, component }, index) => {
        if (version !== 2) return;
        const encoder = new Encoder(system, component, sequence);
        const message = found[index]!;
        if (hexOf(encoder.build(message.name, message.fields as never)) !== packed) wrong.push(`${name} ${index}`);
      });
    }
    expect(wrong).toEqual([]);
  });
});
