/** A board as its bootloader describes it, and the checks before the first erase: those of `mav firmware`. */

import { FlashingError } from './errors';
import type { FirmwareFile } from './firmwareFile';

const MIN_REVISION = 2;
const MAX_REVISION = 6;
/** Minimum protocol revision of a bootloader that reports its chip. */
export const CHIP_REVISION = 5;
/** Ids of other boards whose firmware also runs on a board, by the id of the board. */
const COMPATIBLE: ReadonlyMap<number, readonly number[]> = new Map([[33, [9]]]);
const NAMES: ReadonlyMap<number, string> = new Map([
  [9, 'Pixhawk 1 (FMUv2, FMUv3)'],
  [11, 'Pixracer (FMUv4)'],
  [33, 'AUAV-X2.1'],
  [50, 'Pixhawk 4 (FMUv5)'],
  [51, 'FMUv5X'],
  [53, 'FMUv6X'],
  [56, 'FMUv6C'],
  [57, 'FMUv6U'],
  [140, 'CubeOrange'],
  [1063, 'CubeOrangePlus'],
]);
/** Id of the chip family STM32F42x, and its revisions whose second megabyte of flash cannot be used. */
const F42X = 0x419;
const FLAWED: readonly number[] = [0x1000, 0x1001, 0x1003, 0x1007];
const FAMILY_MASK = 0xfff;
/** Flash of such a chip for the firmware in bytes: one megabyte without 16 kB for the bootloader. */
const FLAWED_SIZE = 1_032_192;
const PIXHAWK = 9;

export interface Board {
  /** Protocol revision of the bootloader. */
  readonly bootloader: number;
  readonly boardId: number;
  readonly boardRevision: number;
  /** Bytes of internal flash for a firmware. */
  readonly flashSize: number;
  /** Bytes of external flash; 0 if it has none. */
  readonly externalSize: number;
  /** Id of the chip, with its revision in the upper half; null if the bootloader does not report it. */
  readonly chip: number | null;
  readonly chipName: string;
  readonly serial: string;
}

/** Returns the name of a board, or its number. */
export function boardName(id: number): string {
  const name = NAMES.get(id);
  return name === undefined ? `board ${id}` : `board ${id}, ${name}`;
}

/** Returns the bytes of internal flash that can be used: a flawed STM32F42x has one megabyte. */
export function usableSize({ bootloader, boardId, flashSize, chip }: Board): number {
  const isFlawed = chip !== null && (chip & FAMILY_MASK) === F42X && FLAWED.includes(chip >>> 16);
  const mayBeFlawed = bootloader < CHIP_REVISION && boardId === PIXHAWK;
  return isFlawed || mayBeFlawed ? Math.min(flashSize, FLAWED_SIZE) : flashSize;
}

/** Throws if a firmware does not fit a board; nothing is sent. */
export function checkFirmware(firmware: FirmwareFile, board: Board): void {
  const name = boardName(board.boardId);
  const refuse = (reason: string): never => {
    throw new FlashingError(`flashing ${name} failed: ${reason}`);
  };
  if (board.bootloader < MIN_REVISION || board.bootloader > MAX_REVISION)
    refuse(
      `its bootloader speaks revision ${board.bootloader} of the protocol, ` +
        `known are ${MIN_REVISION} to ${MAX_REVISION}`,
    );
  const accepted = [board.boardId, ...(COMPATIBLE.get(board.boardId) ?? [])];
  if (!accepted.includes(firmware.boardId))
    refuse(`the firmware is for ${boardName(firmware.boardId)}; get the file for board ${board.boardId}`);
  const size = firmware.image.length;
  const usable = usableSize(board);
  const rest = usable === board.flashSize ? '' : '; its chip cannot use the rest of its flash';
  if (size > usable) refuse(`the firmware has ${size} bytes, the board ${usable}${rest}`);
  if (firmware.maxSize !== null && size > Math.ceil(firmware.maxSize / 4) * 4)
    refuse(`the firmware has ${size} bytes, its file allows ${firmware.maxSize}`);
  if (firmware.external.length > board.externalSize)
    refuse(`the firmware has ${firmware.external.length} bytes of external flash, the board ${board.externalSize}`);
}
