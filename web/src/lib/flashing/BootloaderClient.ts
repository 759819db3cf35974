/**
 * The bootloader of PX4 and ArduPilot, seen by a program: identify, erase, program, verify, start.
 *
 * It does as `mavstack.flashing.bootloader_client` does, proven by the conversations in `conformance/bootloader.jsonl`.
 */

import { CHIP_REVISION, checkFirmware, type Board } from './board';
import {
  Conversation,
  counted,
  fixed,
  INSYNC,
  INVALID,
  numberAt,
  OK,
  refusable,
  type BootloaderLine,
  type ReplySize,
} from './conversation';
import { FlashingError } from './errors';
import type { FirmwareFile } from './firmwareFile';

const EOC = 0x20;
/** Bytes of a block: a multiple of four below 256. */
const BLOCK_SIZE = 252;
/** Milliseconds of the attempts to find the bootloader: it drops an incomplete request after a second. */
const SYNC_TIMEOUTS: readonly number[] = [300, 500, 1300, 1300, 1300];
/** Milliseconds to wait for a detail of the board that old bootloaders do not report. */
const DETAIL_TIMEOUT = 300;
const ERASE_TIMEOUT = 40_000;
const REBOOT_TIMEOUT = 1000;
const CRC_TIMEOUT = 10_000;
const SIGNATURE_TIMEOUT = 5000;
const EXTERNAL_TIMEOUT = 120_000;
/** Number of blocks between two reports. */
const REPORT_BLOCKS = 32;

const Op = {
  GET_SYNC: 0x21,
  GET_DEVICE: 0x22,
  CHIP_ERASE: 0x23,
  CHIP_VERIFY: 0x24,
  PROG_MULTI: 0x27,
  READ_MULTI: 0x28,
  GET_CRC: 0x29,
  GET_SN: 0x2b,
  GET_CHIP: 0x2c,
  GET_CHIP_DES: 0x2e,
  REBOOT: 0x30,
  EXTF_ERASE: 0x34,
  EXTF_PROG_MULTI: 0x35,
  EXTF_GET_CRC: 0x37,
  VERIFY_SIG: 0x39,
} as const;
const Device = { PROTOCOL_REVISION: 1, BOARD_ID: 2, BOARD_REVISION: 3, FLASH_SIZE: 4, EXTERNAL_SIZE: 6 } as const;

export type FlashPhase = 'erase' | 'program' | 'verify' | 'erase-external' | 'program-external';
/** Called with the phase, and the bytes done and in total; both 0 while they are not known. */
export type ReportProgress = (phase: FlashPhase, done: number, total: number) => void;

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit += 1) value = value & 1 ? (value >>> 1) ^ 0xedb8_8320 : value >>> 1;
  return value;
});

/** Returns the CRC of a flash with an image: CRC-32 that begins with 0 and is not inverted at the end. */
export function flashCrc(image: Uint8Array, size: number): number {
  let crc = 0;
  for (const byte of image) crc = CRC_TABLE[(crc ^ byte) & 0xff]! ^ (crc >>> 8);
  for (let at = image.length; at < size; at += 1) crc = CRC_TABLE[(crc ^ 0xff) & 0xff]! ^ (crc >>> 8);
  return crc >>> 0;
}

export class BootloaderClient {
  private readonly conversation: Conversation;

  constructor(line: BootloaderLine) {
    this.conversation = new Conversation(line);
  }

  close(reason?: string): void {
    this.conversation.close(reason);
  }

  /** Finds the bootloader, and identifies the board. */
  async identify(attempts = SYNC_TIMEOUTS.length): Promise<Board> {
    await this.sync(attempts);
    const first = await this.device(Device.PROTOCOL_REVISION);
    const external = await this.detail(() => this.externalSize());
    let chip: number | null = null;
    let chipName: string | null = null;
    let serial: string | null = null;
    if (first >= CHIP_REVISION) {
      chip = await this.detail(() => this.number(Op.GET_CHIP, [], 'identifying the board', DETAIL_TIMEOUT));
      chipName = await this.detail(() => this.text(Op.GET_CHIP_DES));
    }
    if (first >= CHIP_REVISION - 1) serial = await this.detail(() => this.serial());
    // These four come last: a bootloader erases only if all of them were requested since it started.
    return {
      bootloader: await this.device(Device.PROTOCOL_REVISION),
      boardId: await this.device(Device.BOARD_ID),
      boardRevision: await this.device(Device.BOARD_REVISION),
      flashSize: await this.device(Device.FLASH_SIZE),
      externalSize: external ?? 0,
      chip,
      chipName: chipName ?? '',
      serial: serial ?? '',
    };
  }

  /** Erases, programs and verifies; the firmware is checked first. */
  async flash(firmware: FirmwareFile, board: Board, report: ReportProgress = () => undefined): Promise<void> {
    checkFirmware(firmware, board);
    if (firmware.external.length > 0) await this.flashExternal(firmware.external, report);
    report('erase', 0, 0);
    await unlessRestarted('erasing', () => this.request(Op.CHIP_ERASE, [], 'erasing', fixed(0), ERASE_TIMEOUT));
    await this.program(Op.PROG_MULTI, firmware.image, (done, total) => report('program', done, total));
    report('verify', 0, 0);
    await this.verify(firmware, board);
  }

  /** Starts the firmware, and makes sure that the bootloader is gone. */
  async reboot(): Promise<void> {
    try {
      await this.request(Op.REBOOT, [], 'starting the firmware', fixed(0), REBOOT_TIMEOUT);
    } catch (error) {
      if (error instanceof FlashingError && error.status !== null && error.status > 0) throw error;
      await this.checkGone();
    }
  }

  private async checkGone(): Promise<void> {
    try {
      await this.sync(1);
    } catch {
      return;
    }
    throw new FlashingError('starting the firmware failed: the board is in its bootloader again');
  }

  private async sync(attempts = SYNC_TIMEOUTS.length): Promise<void> {
    for (const [index, timeout] of SYNC_TIMEOUTS.slice(0, attempts).entries()) {
      try {
        await this.request(Op.GET_SYNC, [], 'finding the bootloader', fixed(0), timeout);
        return;
      } catch (error) {
        if (index + 1 === attempts) throw error;
      }
    }
  }

  private async verify({ image, isSigned, kind }: FirmwareFile, board: Board): Promise<void> {
    if (board.bootloader === 2) await this.verifyByReading(image);
    else compare(await this.number(Op.GET_CRC, [], 'verifying', CRC_TIMEOUT), flashCrc(image, board.flashSize));
    // Only for PX4: ArduPilot's bootloaders verify the signature by themselves before they start a firmware.
    if (isSigned && kind === 'px4') await this.verifySignature();
  }

  private async verifyByReading(image: Uint8Array): Promise<void> {
    await this.request(Op.CHIP_VERIFY, [], 'verifying');
    for (let start = 0; start < image.length; start += BLOCK_SIZE) {
      const block = image.subarray(start, start + BLOCK_SIZE);
      const read = await this.request(Op.READ_MULTI, [block.length], 'verifying', fixed(block.length));
      if (read.some((byte, at) => byte !== block[at]))
        throw new FlashingError(`verifying failed: the flash differs at byte ${start}; flash it again`);
    }
  }

  private async verifySignature(): Promise<void> {
    try {
      await this.request(Op.VERIFY_SIG, [], 'verifying the signature', fixed(0), SIGNATURE_TIMEOUT);
    } catch (error) {
      if (!(error instanceof FlashingError) || (error.status !== INVALID && error.status !== null)) throw error;
      const text = 'verifying the signature failed: the bootloader has no secure boot; flash one without';
      throw new FlashingError(text, error.status);
    }
  }

  private async flashExternal(image: Uint8Array, report: ReportProgress): Promise<void> {
    const size = word(image.length);
    report('erase-external', 0, 0);
    const operation = 'erasing the external flash';
    await unlessRestarted(operation, () =>
      this.request(Op.EXTF_ERASE, size, operation, externalErased, EXTERNAL_TIMEOUT),
    );
    await this.program(Op.EXTF_PROG_MULTI, image, (done, total) => report('program-external', done, total));
    const found = await this.number(Op.EXTF_GET_CRC, size, 'verifying the external flash', EXTERNAL_TIMEOUT);
    compare(found, flashCrc(image, image.length));
  }

  private program(op: number, image: Uint8Array, report: (done: number, total: number) => void): Promise<void> {
    return unlessRestarted('programming', async () => {
      for (let start = 0; start < image.length; start += BLOCK_SIZE) {
        const block = image.subarray(start, start + BLOCK_SIZE);
        if ((start / BLOCK_SIZE) % REPORT_BLOCKS === 0) report(start, image.length);
        await this.request(op, [block.length, ...block], 'programming');
      }
      report(image.length, image.length);
    });
  }

  private async externalSize(): Promise<number> {
    const reply = await this.request(
      Op.GET_DEVICE,
      [Device.EXTERNAL_SIZE],
      'identifying the board',
      refusable(4),
      DETAIL_TIMEOUT,
    );
    return numberAt(reply, 0);
  }

  private async serial(): Promise<string> {
    const words: string[] = [];
    for (const place of [0, 4, 8]) {
      const value = await this.number(Op.GET_SN, word(place), 'identifying the board', DETAIL_TIMEOUT);
      words.push(value.toString(16).padStart(8, '0'));
    }
    return words.join('');
  }

  private async text(op: number): Promise<string> {
    const reply = await this.request(op, [], 'identifying the board', counted, DETAIL_TIMEOUT);
    return new TextDecoder('ascii').decode(reply.subarray(4)).replace(/\0+$/, '');
  }

  private device(which: number): Promise<number> {
    return this.number(Op.GET_DEVICE, [which], 'identifying the board');
  }

  private async number(op: number, argument: readonly number[], operation: string, timeout?: number): Promise<number> {
    return numberAt(await this.request(op, argument, operation, fixed(4), timeout), 0);
  }

  /** Reads a value that old bootloaders do not know; null then. */
  private async detail<Value>(read: () => Promise<Value>): Promise<Value | null> {
    try {
      return await read();
    } catch {
      await this.sync();
      return null;
    }
  }

  private request(
    op: number,
    argument: readonly number[],
    operation: string,
    size: ReplySize = fixed(0),
    timeout?: number,
  ): Promise<Uint8Array> {
    const data = Uint8Array.from([op, ...argument, EOC]);
    return this.conversation.ask({ data, operation, size, ...(timeout === undefined ? {} : { timeout }) });
  }
}

/** Explains a request that a bootloader does not accept, since it was restarted after it was identified. */
async function unlessRestarted<Value>(operation: string, work: () => Promise<Value>): Promise<Value> {
  try {
    return await work();
  } catch (error) {
    if (error instanceof FlashingError && error.status === INVALID)
      throw new FlashingError(`${operation} failed: the board restarted meanwhile`);
    throw error;
  }
}

/** Finds the end of erasing: a status, percentages up to 100, and a status. */
function externalErased(data: Uint8Array): number | null {
  if (data.length >= 2 && data[1] !== OK) return 2;
  const [percentage, mark, status] = data.subarray(-3);
  return percentage === 100 && mark === INSYNC && status === OK ? data.length : null;
}

function compare(found: number, expected: number): void {
  const hex = (value: number): string => `0x${value.toString(16).padStart(8, '0')}`;
  if (found !== expected)
    throw new FlashingError(
      `verifying failed: the CRC of the flash is ${hex(found)}, not ${hex(expected)}; flash it again`,
    );
}

const word = (value: number): number[] => [value & 0xff, (value >>> 8) & 0xff, (value >>> 16) & 0xff, value >>> 24];
