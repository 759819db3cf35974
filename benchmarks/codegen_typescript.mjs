// Measures a TypeScript library: `node codegen_typescript.mjs LIBRARY FOLDER MODE FILE`.
//
// The file holds 2 bytes of length before each packet. The program runs WARM_UPS times for the compiler of Node, once
// measured, and prints the number of messages and the seconds.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const [library, folder, mode, file] = process.argv.slice(2);
const CHUNK = 16384;
const ENCODED = 50_000;
const WARM_UPS = 5;

/** The packets of the file, one by one and as chunks of the stream. */
function read() {
  const content = readFileSync(file);
  const packets = [];
  for (let at = 0; at < content.length; at += 2 + packets.at(-1).length) {
    packets.push(content.subarray(at + 2, at + 2 + content.readUInt16LE(at)));
  }
  const stream = Buffer.concat(packets);
  const chunks = [];
  for (let at = 0; at < stream.length; at += CHUNK) chunks.push(stream.subarray(at, at + CHUNK));
  return { packets, chunks };
}

const values = (index) => ({
  timeBootMs: index, roll: 0.1, pitch: 0.2, yaw: index, rollspeed: 1, pitchspeed: 2, yawspeed: 3,
});

const works = {
  async mavstack() {
    const { Attitude, PacketBuilder, Parser, messages } = await import(pathToFileURL(`${folder}/dist/index.js`));
    const { chunks } = read();
    const decode = () => {
      const parser = new Parser(messages);
      let count = 0;
      for (const chunk of chunks) for (const packet of parser.push(chunk)) count += packet.fields.toObject() ? 1 : 0;
      return count;
    };
    const builder = new PacketBuilder({ system: 1, component: 1 });
    const encode = () => {
      for (let index = 0; index < ENCODED; index++) builder.build(Attitude, values(index));
      return ENCODED;
    };
    return { decode, encode };
  },

  async "node-mavlink"() {
    const peer = createRequire(`${folder}/x.js`)("node-mavlink");
    const { chunks } = read();
    const registry = { ...peer.minimal.REGISTRY, ...peer.standard.REGISTRY, ...peer.common.REGISTRY, ...peer.ardupilotmega.REGISTRY };
    const decode = async () => {
      const splitter = new peer.MavLinkPacketSplitter();
      const parser = splitter.pipe(new peer.MavLinkPacketParser());
      let count = 0;
      parser.on("data", (packet) => {
        count += packet.protocol.data(packet.payload, registry[packet.header.msgid]) ? 1 : 0;
      });
      for (const chunk of chunks) {
        if (!splitter.write(chunk)) await new Promise((resolve) => splitter.once("drain", resolve));
      }
      splitter.end();
      await new Promise((resolve) => parser.on("end", resolve));
      return count;
    };
    const message = new peer.common.Attitude();
    const protocol = new peer.MavLinkProtocolV2(1, 1);
    const encode = () => {
      for (let index = 0; index < ENCODED; index++) {
        Object.assign(message, values(index));
        protocol.serialize(message, index & 0xff);
      }
      return ENCODED;
    };
    return { decode, encode };
  },

  async mavgen() {
    const load = createRequire(`${folder}/x.js`);
    const { MAVLinkModule } = load("@ifrunistuttgart/node-mavlink");
    const { messageRegistry } = load("./message-registry.js");
    const module = new MAVLinkModule(messageRegistry, 1, false);
    console.log = () => {};
    module.upgradeLink();
    const { packets } = read();
    let count = 0;
    module.on("message", () => count++);
    const decode = async () => {
      count = 0;
      for (const packet of packets) await module.parse(packet);
      return count;
    };
    const message = new (new Map(messageRegistry).get(30))(1, 1);
    const encode = () => {
      for (let index = 0; index < ENCODED; index++) {
        Object.assign(message, values(index), { time_boot_ms: index });
        module.pack([message]);
      }
      return ENCODED;
    };
    return { decode, encode };
  },
};

const work = (await works[library]())[mode];
for (let turn = 0; turn < WARM_UPS; turn++) await work();
const start = process.hrtime.bigint();
const count = await work();
const seconds = Number(process.hrtime.bigint() - start) / 1e9;
process.stdout.write(`${count} ${seconds}\n`);
process.exit(0);
