// Types of a generated library: what compiles, and what must not compile.

import { Attitude, Heartbeat, MavAutopilot, MavModeFlag, MavType, PacketBuilder, Parser, Statustext, SystemTime, messages } from "./index.js";
import { flagsOf, nameOf } from "./index.js";
import type { AnyPacket } from "./index.js";

export function describe(message: AnyPacket): string {
  switch (message.name) {
    case "ATTITUDE":
      // @ts-expect-error another message's field
      void message.fields.batteryRemaining;
      return message.fields.roll.toFixed(2);
    case "HEARTBEAT":
      return message.fields.type === MavType.QUADROTOR ? "quadrotor" : (nameOf(MavType, message.fields.type) ?? "other");
    case "SYSTEM_TIME":
      return `${message.fields.timeUnixUsec + 1n}`;
    // @ts-expect-error no message has this name
    case "ATITUDE":
      return "";
    default:
      return "";
  }
}

export function some(data: Uint8Array): number {
  let total = 0;
  for (const message of new Parser([Attitude, SystemTime]).push(data)) {
    if (message.name === "ATTITUDE") total += message.fields.yaw;
    else total += Number(message.fields.timeUnixUsec);
    // @ts-expect-error the parser does not know this message
    if (message.name === "HEARTBEAT") total++;
  }
  return total;
}

export function build(): Uint8Array[] {
  const builder = new PacketBuilder({ system: 255, component: 190 });
  const heartbeat = {
    type: MavType.GCS, autopilot: MavAutopilot.INVALID, baseMode: 0, customMode: 0, systemStatus: 200,
  };
  // @ts-expect-error a field is missing
  builder.build(Heartbeat, { type: MavType.GCS });
  // @ts-expect-error 64-bit integers are bigints
  builder.build(SystemTime, { timeUnixUsec: 1, timeBootMs: 1 });
  return [
    builder.build(Heartbeat, heartbeat),
    builder.build(Heartbeat, { ...heartbeat, mavlinkVersion: 3 }),
    builder.build(Statustext, { severity: 6, text: "extensions may be left out" }),
    builder.build(SystemTime, { timeUnixUsec: 1n, timeBootMs: 1 }),
  ];
}

export const known: number = messages.length;
export const flags: ("SAFETY_ARMED" | string)[] = flagsOf(MavModeFlag, 0x81);
// @ts-expect-error fields are read only
export function change(message: Attitude): void { message.roll = 1; }
