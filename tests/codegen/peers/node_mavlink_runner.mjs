// The conformance runner of node-mavlink: node node_mavlink_runner.mjs FOLDER, in which npm installed it.
import { createInterface } from "node:readline";
import { createRequire } from "node:module";
import { join } from "node:path";

const require = createRequire(join(process.argv[2], "package.json"));
const { MavLinkPacketParser, MavLinkPacketSplitter, MavLinkProtocolV1, MavLinkProtocolV2, minimal, standard, common } = require("node-mavlink");
const REGISTRY = { ...minimal.REGISTRY, ...standard.REGISTRY, ...common.REGISTRY };
const WRITERS = {
  int8_t: "writeInt8", uint8_t: "writeUInt8", int16_t: "writeInt16LE", uint16_t: "writeUInt16LE",
  int32_t: "writeInt32LE", uint32_t: "writeUInt32LE", int64_t: "writeBigInt64LE", uint64_t: "writeBigUInt64LE",
  float: "writeFloatLE", double: "writeDoubleLE", uint8_t_mavlink_version: "writeUInt8",
};

function fieldBytes(field, value) {
  const kind = field.type.replace("[]", "");
  const length = field.length || 1;
  const buffer = Buffer.alloc(field.size * length);
  if (kind === "char") buffer.write(value);
  else (Array.isArray(value) ? value : [value]).forEach((item, i) => buffer[WRITERS[kind]](item, i * field.size));
  return buffer.toString("hex");
}

function show(packet, key) {
  const { header } = packet;
  const kind = REGISTRY[header.msgid];
  if (!kind) return;
  const version = header.magic === 0xfd ? 2 : 1;
  const data = packet.protocol.data(packet.payload, kind);
  const fields = kind.FIELDS.map((field) => `${field.source}=${fieldBytes(field, data[field.name])}`);
  const signed = packet.signature ? 1 : 0;
  const words = [kind.MSG_NAME, header.msgid, version, header.seq, header.sysid, header.compid, signed, ...fields];
  console.log(`packet ${words.join(" ")}`);
  const Protocol = version === 2 ? MavLinkProtocolV2 : MavLinkProtocolV1;
  const packed = new Protocol(header.sysid, header.compid).serialize(data, header.seq);
  console.log(`packed ${kind.MSG_NAME} ${packed.toString("hex")}`);
}

for await (const line of createInterface({ input: process.stdin })) {
  const [name, key, , hex] = line.split(" ");
  const secret = key === "-" ? null : Buffer.from(key, "hex");
  const splitter = new MavLinkPacketSplitter();
  const packets = [];
  splitter.pipe(new MavLinkPacketParser()).on("data", (packet) => packets.push(packet));
  splitter.write(Buffer.from(hex, "hex"));
  for (let turn = 0; turn < 4; turn++) await new Promise(setImmediate);
  for (const packet of packets) {
    // The library leaves it to the program to compare signatures; it keeps no timestamps.
    if (secret && !packet.signature?.matches(secret)) continue;
    try {
      show(packet, secret);
    } catch (error) {
      console.log(`failed ${error.message.split("\n")[0]}`);
    }
  }
  console.log(`end ${name}`);
}
