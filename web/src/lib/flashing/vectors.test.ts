/** The conversations with bootloaders that Python's client writes (`conformance/bootloader.jsonl`). */

import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { BootloaderClient, flashCrc } from './BootloaderClient';
import { checkFirmware, type Board } from './board';
import { MAX_SIZE, parseFirmware, type FirmwareFile } from './firmwareFile';

interface Vector {
  readonly name: string;
  readonly file: string;
  readonly board: number;
  readonly steps: readonly (readonly [request: string, answer: string])[];
  readonly error: string | null;
}

const path = join(import.meta.dirname, '../../../../conformance/bootloader.jsonl');
const vectors = readFileSync(path, 'ascii')
  .trim()
  .split('\n')
  .map((line) => JSON.parse(line) as Vector);
const hex = (data: Uint8Array): string => Buffer.from(data).toString('hex');

/** A bootloader that expects the requests of a vector, and gives its answers. */
class Recorded {
  readonly sent: string[] = [];
  private readonly vector: Vector;
  private listener: ((data: Uint8Array) => void) | null = null;

  constructor(vector: Vector) {
    this.vector = vector;
  }

  send(data: Uint8Array): void {
    const [request, answer] = this.vector.steps[this.sent.length] ?? ['nothing', ''];
    this.sent.push(hex(data));
    if (hex(data) !== request || answer === '') return;
    const bytes = Uint8Array.from(Buffer.from(answer, 'hex'));
    // In two parts, as a serial line gives them.
    const half = bytes.length >> 1;
    queueMicrotask(() => this.listener?.(bytes.slice(0, half)));
    queueMicrotask(() => this.listener?.(bytes.slice(half)));
  }

  onData(listener: (data: Uint8Array) => void): () => void {
    this.listener = listener;
    return () => (this.listener = null);
  }
}

async function flashed(line: Recorded, firmware: FirmwareFile): Promise<string | null> {
  const client = new BootloaderClient(line);
  try {
    const board = await client.identify();
    await client.flash(firmware, board);
    await client.reboot();
  } catch (error) {
    return (error as Error).message;
  } finally {
    client.close();
  }
  return null;
}

describe('flashing', () => {
  beforeEach(() => void vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout'] }));
  afterEach(() => void vi.useRealTimers());

  for (const vector of vectors) {
    it(`passes the vector ${vector.name}`, async () => {
      const firmware = await parseFirmware(new Blob([Buffer.from(vector.file, 'base64')]), 'file');
      const line = new Recorded(vector);
      let outcome: string | null | undefined;
      void flashed(line, firmware).then((result) => (outcome = result));
      for (let turn = 0; turn < 200 && outcome === undefined; turn += 1) await vi.advanceTimersByTimeAsync(500);
      expect(outcome).toBe(vector.error);
      expect(line.sent).toEqual(vector.steps.map(([request]) => request));
    });
  }

  it('refuses a flash that a flawed chip cannot use', () => {
    const board: Board = {
      bootloader: 5,
      boardId: 9,
      boardRevision: 0,
      flashSize: 2_080_768,
      externalSize: 0,
      chip: 0x1003_0419,
      chipName: '',
      serial: '',
    };
    const firmware: FirmwareFile = {
      kind: 'px4',
      image: new Uint8Array(1_032_196),
      external: new Uint8Array(),
      boardId: 9,
      maxSize: null,
      isSigned: false,
      name: '',
      version: '',
    };
    expect(() => checkFirmware(firmware, board)).toThrow('its chip cannot use the rest of its flash');
    checkFirmware(firmware, { ...board, chip: 0x2001_0419 });
  });

  it('fails when the port is lost', async () => {
    const line = new Recorded({ ...vectors[0]!, steps: [] });
    const client = new BootloaderClient(line);
    const identified = client.identify();
    const failure = expect(identified).rejects.toThrow('finding the bootloader failed: the port was unplugged');
    client.close('the port was unplugged');
    await failure;
    await expect(client.identify()).rejects.toThrow('the port was unplugged');
  });

  it('computes the CRC of a whole flash', () => {
    expect(flashCrc(new TextEncoder().encode('123456789'), 9)).toBe(0x2dfd_2d88);
  });
});

describe('files', () => {
  it('that are damaged are refused in words', async () => {
    const refused: readonly (readonly [string, string])[] = [
      ['{', 'not JSON, the file may be cut off'],
      ['[]', 'not an object of JSON'],
      ['{}', 'neither a .px4 nor an .apj file'],
      ['{"magic":"PX4FWv1"}', 'does not name its board'],
      ['{"magic":"PX4FWv1","board_id":9}', 'has no image'],
      ['{"magic":"PX4FWv1","board_id":9,"image":"AAAA"}', 'image is damaged'],
    ];
    for (const [text, reason] of refused)
      await expect(parseFirmware(new Blob([text]), 'a.px4')).rejects.toThrow(reason);
  });

  it('that are larger than any firmware are not read', async () => {
    const file = { size: MAX_SIZE + 1, arrayBuffer: () => expect.unreachable() } as unknown as Blob;
    await expect(parseFirmware(file, 'a.px4')).rejects.toThrow('more than 64 MB');
  });
});
