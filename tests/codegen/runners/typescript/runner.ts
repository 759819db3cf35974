// Runner of the conformance corpus, over the message tables of a generated TypeScript library.
//
// It reads lines `NAME KEY|- NOW|- HEX` and prints the packets, the packets built again, and the counters. Its argument
// is the length of the chunks that the parser gets.

import { readFileSync } from "node:fs";

import { Parser, Signing, encode, messages } from "./index.js";
import type { AnyMessageType, AnyPacket, FieldInfo, PacketHeader } from "./index.js";

const SIZES: Readonly<Record<FieldInfo["type"], number>> = {
  char: 1, int8_t: 1, uint8_t: 1, int16_t: 2, uint16_t: 2, int32_t: 4, uint32_t: 4,
  int64_t: 8, uint64_t: 8, float: 4, double: 8,
};

function hex(bytes: Uint8Array): string {
  return Buffer.from(bytes).toString("hex");
}

function putNumber(view: DataView, at: number, type: FieldInfo["type"], value: number | bigint): void {
  if (typeof value === "bigint") view.setBigUint64(at, BigInt.asUintN(64, value), true);
  else if (type === "float") view.setFloat32(at, value, true);
  else if (type === "double") view.setFloat64(at, value, true);
  else if (SIZES[type] === 4) view.setInt32(at, value, true);
  else if (SIZES[type] === 2) view.setInt16(at, value, true);
  else view.setInt8(at, value);
}

function fieldHex(field: FieldInfo, value: unknown): string {
  const size = SIZES[field.type];
  const view = new DataView(new ArrayBuffer(size * Math.max(field.arrayLength, 1)));
  if (typeof value === "string") {
    Buffer.from(value).forEach((byte, index) => view.setUint8(index, byte));
  } else {
    const values = (field.arrayLength ? Array.from(value as ArrayLike<number | bigint>) : [value]) as number[];
    values.forEach((item, index) => putNumber(view, index * size, field.type, item));
  }
  return hex(new Uint8Array(view.buffer));
}

function packedAgain(packet: AnyPacket, key: Uint8Array | undefined): Uint8Array {
  const { system, component, sequence, version, signed, linkId, signatureTimestamp } = packet;
  let header: PacketHeader = { system, component, sequence, version };
  if (signed && key !== undefined) {
    const signing = new Signing(key, { linkId, timestamp: signatureTimestamp - 1, now: () => undefined });
    header = { ...header, signing };
  }
  return encode(packet.type as AnyMessageType, packet.fields.toObject() as never, header);
}

function pushed(parser: Parser<(typeof messages)[number]>, data: Uint8Array): AnyPacket[] {
  const size = Number(process.argv[2] ?? data.length);
  const packets: AnyPacket[] = [];
  for (let start = 0; start < data.length; start += size) packets.push(...parser.push(data.subarray(start, start + size)));
  return packets;
}

function run(line: string, out: string[]): void {
  const [name = "", keyHex = "-", now = "-", data = ""] = line.split(" ");
  const key = keyHex === "-" ? undefined : new Uint8Array(Buffer.from(keyHex, "hex"));
  const time = now === "-" ? undefined : Number(now);
  const options = key === undefined ? {} : { signing: new Signing(key, { now: () => time, timestamp: time ?? 0 }) };
  const parser = new Parser(messages, options);
  for (const packet of pushed(parser, new Uint8Array(Buffer.from(data, "hex")))) {
    const { id, version, sequence, system, component, signed } = packet;
    const object = packet.fields.toObject() as unknown as Readonly<Record<string, unknown>>;
    const fields = packet.info.fields.map((field) => `${field.name}=${fieldHex(field, object[field.property])}`);
    out.push(`packet ${packet.name} ${id} ${version} ${sequence} ${system} ${component} ${Number(signed)} ${fields.join(" ")}`);
    out.push(`packed ${packet.name} ${hex(packedAgain(packet, key))}`);
  }
  const { good, badCrc, badSignature, unknown } = parser.counters;
  out.push(`end ${name} good=${good} bad_crc=${badCrc} bad_signature=${badSignature} unknown=${unknown}`);
}

const out: string[] = [];
for (const line of readFileSync(0, "utf8").split("\n")) if (line !== "") run(line, out);
process.stdout.write(`${out.join("\n")}\n`);
