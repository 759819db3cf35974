/** A running autopilot at a port: it is asked to start its bootloader. */

import { MavAutopilot, MavCmd, MavModeFlag, MavResult } from '$generated';

import { Decoder, Encoder, enumName } from '$lib/decoder/Decoder';

import type { BootloaderLine } from './conversation';
import { FlashingError } from './errors';

/** Milliseconds to wait for a heartbeat, and for the acknowledgement of the command. */
const HEARTBEAT_TIMEOUT = 4000;
const ACK_TIMEOUT = 3000;
/** Param 1 of MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN. */
const STAY_IN_BOOTLOADER = 3;

export interface Autopilot {
  readonly system: number;
  readonly component: number;
  readonly isArmed: boolean;
}

/** Resolves to the autopilot that sends heartbeats; null: none does.
 *
 * @param wanted - Its system id; null: the first that is received. A radio may receive several vehicles.
 */
export function findAutopilot(
  line: BootloaderLine,
  wanted: number | null = null,
  timeout = HEARTBEAT_TIMEOUT,
): Promise<Autopilot | null> {
  return new Promise((resolve) => {
    const decoder = new Decoder();
    const end = (found: Autopilot | null): void => {
      clearTimeout(timer);
      stop();
      resolve(found);
    };
    const timer = setTimeout(() => end(null), timeout);
    const stop = line.onData((data) => {
      for (const { name, system, component, fields } of decoder.push(data)) {
        // Gimbals, companion computers and ground stations have none, and do not show whether the vehicle is armed.
        if (name !== 'HEARTBEAT' || fields.autopilot === MavAutopilot.INVALID) continue;
        if (wanted !== null && system !== wanted) continue;
        end({ system, component, isArmed: (Number(fields.base_mode) & MavModeFlag.SAFETY_ARMED) !== 0 });
        return;
      }
    });
  });
}

/** Asks an autopilot to start its bootloader, whereupon the port disappears; throws if it is armed or refuses.
 *
 * @returns True if it has confirmed. A board may restart before its acknowledgement has left.
 */
export async function startBootloader(line: BootloaderLine, autopilot: Autopilot): Promise<boolean> {
  const { system, component, isArmed } = autopilot;
  if (isArmed) throw new FlashingError(`flashing vehicle ${system} failed: it is armed; disarm it first`);
  const acknowledged = acknowledgement(line, system);
  line.send(
    new Encoder().build('COMMAND_LONG', {
      target_system: system,
      target_component: component,
      command: MavCmd.PREFLIGHT_REBOOT_SHUTDOWN,
      param1: STAY_IN_BOOTLOADER,
    }),
  );
  const result = await acknowledged;
  if (result === null) return false;
  if (result === MavResult.ACCEPTED || result === MavResult.IN_PROGRESS) return true;
  const name = enumName('MAV_RESULT', result) ?? String(result);
  throw new FlashingError(`starting the bootloader of vehicle ${system} failed: ${name}`);
}

/** Resolves to the result of MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN; null: none came in time. */
function acknowledgement(line: BootloaderLine, wanted: number): Promise<number | null> {
  return new Promise((resolve) => {
    const decoder = new Decoder();
    const end = (result: number | null): void => {
      clearTimeout(timer);
      stop();
      resolve(result);
    };
    const timer = setTimeout(() => end(null), ACK_TIMEOUT);
    const stop = line.onData((data) => {
      for (const { name, system, fields } of decoder.push(data)) {
        const isAnswer = name === 'COMMAND_ACK' && fields.command === MavCmd.PREFLIGHT_REBOOT_SHUTDOWN;
        if (isAnswer && system === wanted) return end(Number(fields.result));
      }
    });
  });
}
