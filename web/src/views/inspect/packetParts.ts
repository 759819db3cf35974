/** The parts of a packet, for a view of its bytes. */
import type { MessageInfo } from '$generated';
import { SIZES } from '$lib/decoder/Decoder';

export type PartKind = 'header' | 'ids' | 'message' | 'payload' | 'checksum' | 'signature';

export interface PacketPart {
  readonly kind: PartKind;
  /** Name of a field of the message; parts of all packets have the one that MAVLink gives them. */
  readonly name: string;
  readonly start: number;
  readonly end: number;
}

const MAGIC_V2 = 0xfd;
const V1: readonly [PartKind, string, number][] = [
  ['header', 'magic', 1],
  ['header', 'len', 1],
  ['header', 'seq', 1],
  ['ids', 'sysid', 1],
  ['ids', 'compid', 1],
  ['message', 'msgid', 1],
];
const V2: readonly [PartKind, string, number][] = [
  ['header', 'magic', 1],
  ['header', 'len', 1],
  ['header', 'incompat_flags', 1],
  ['header', 'compat_flags', 1],
  ['header', 'seq', 1],
  ['ids', 'sysid', 1],
  ['ids', 'compid', 1],
  ['message', 'msgid', 3],
];

/** Returns the parts of a whole packet in order; fields of the payload by name if the message is known. */
export function packetParts(packet: Uint8Array, info: MessageInfo | null): PacketPart[] {
  const parts: PacketPart[] = [];
  const add = (kind: PartKind, name: string, length: number): void => {
    const start = parts.at(-1)?.end ?? 0;
    if (length > 0) parts.push({ kind, name, start, end: Math.min(packet.length, start + length) });
  };
  for (const [kind, name, length] of packet[0] === MAGIC_V2 ? V2 : V1) add(kind, name, length);
  const payload = parts.at(-1)!.end;
  const end = Math.min(packet.length, payload + (packet[1] ?? 0));
  for (const { name, offset, length } of fieldSpans(info)) {
    if (payload + offset < end) add('payload', name, Math.min(length, end - payload - offset));
  }
  // Bytes behind the known fields: an unknown message, or a newer definition of it.
  add('payload', 'payload', end - parts.at(-1)!.end);
  add('checksum', 'checksum', Math.min(2, packet.length - end));
  add('signature', 'signature', packet.length - parts.at(-1)!.end);
  return parts;
}

function fieldSpans(info: MessageInfo | null): { name: string; offset: number; length: number }[] {
  const spans = (info?.fields ?? []).map(({ name, type, offset, arrayLength }) => ({
    name,
    offset,
    length: (SIZES[type] ?? 1) * Math.max(1, arrayLength),
  }));
  return spans.sort((a, b) => a.offset - b.offset);
}

export function hex(byte: number): string {
  return byte.toString(16).padStart(2, '0');
}
