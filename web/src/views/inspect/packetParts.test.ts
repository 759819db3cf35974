import { expect, it } from 'vitest';
import { Encoder, messageInfo } from '$lib/decoder/Decoder';
import { hex, packetParts } from './packetParts';

const HEARTBEAT = new Encoder(255, 190).build('HEARTBEAT', { type: 6, autopilot: 8, system_status: 4 });

it('covers each byte of a packet once, with the fields in the order of the wire', () => {
  const parts = packetParts(HEARTBEAT, messageInfo('HEARTBEAT'));
  expect(parts[0]!.start).toBe(0);
  parts.slice(1).forEach((part, index) => expect(part.start).toBe(parts[index]!.end));
  expect(parts.at(-1)).toMatchObject({ kind: 'checksum', end: HEARTBEAT.length });
  const fields = parts.filter((part) => part.kind === 'payload').map((part) => part.name);
  expect(fields).toEqual(['custom_mode', 'type', 'autopilot', 'base_mode', 'system_status', 'mavlink_version']);
});

it('shows the payload of unknown messages as one part', () => {
  const names = packetParts(HEARTBEAT, null).map((part) => part.name);
  expect(names.filter((name) => name === 'payload')).toHaveLength(1);
});

it('marks a trimmed payload and a signature', () => {
  const signed = new Uint8Array([0xfd, 1, 1, 0, 9, 1, 1, 0, 0, 0, 5, 0xaa, 0xbb, ...new Array<number>(13).fill(7)]);
  const parts = packetParts(signed, messageInfo('HEARTBEAT'));
  expect(parts.find((part) => part.name === 'custom_mode')).toMatchObject({ start: 10, end: 11 });
  expect(parts.at(-1)).toMatchObject({ kind: 'signature', start: 13, end: 26 });
});

it('reads version 1', () => {
  const packet = new Uint8Array([0xfe, 1, 9, 1, 1, 0, 5, 0xaa, 0xbb]);
  expect(packetParts(packet, null).map((part) => [part.name, part.start])).toContainEqual(['checksum', 7]);
});

it('writes bytes with two digits', () => expect(hex(10)).toBe('0a'));
