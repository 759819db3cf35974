/** A flight controller that speaks MSP: requests one after the other, repeated until they are answered, and its CLI. */

import { CliDialog, isLeaving } from './cli';
import { decodeMessage, encodeMessage, type MspFields } from './codec';
import { messageFacts, type Firmware, type Variant } from './facts';
import { encodeFrame, FrameReader, type Frame } from './frame';

/** The line to the flight controller. */
export interface MspLine {
  send(data: Uint8Array): void;
  /** Registers the receiver of its bytes; returns the function that removes it. */
  onData(listener: (data: Uint8Array) => void): () => void;
}

export class MspError extends Error {
  override name = 'MspError';
}

/** The flight controller refused a command: its firmware was built without it, or its state does not permit it. */
export class MspRefused extends MspError {}

export interface Identity extends Firmware {
  /** Name of the firmware, such as Betaflight. */
  readonly firmware: string;
  readonly version: string;
  readonly board: string;
  readonly name: string;
}

/** Milliseconds for one reply; writing of settings takes longer. */
const REPLY_TIMEOUT = 700;
const SAVE_TIMEOUT = 4000;
const ATTEMPTS = 3;
const CLI_GUARD = 300;
const CLI_TIMEOUT = 8000;
/** Commands that have no table: they are the same in all firmwares. */
const API_VERSION = 1;
const FC_VARIANT = 2;
const FC_VERSION = 3;
const BOARD_INFO = 4;
const NAME = 10;
const EEPROM_WRITE = 250;
const REBOOT = 68;
const NAMES: Readonly<Record<string, string>> = { BTFL: 'Betaflight', INAV: 'iNav' };

interface Waiting {
  readonly command: number;
  resolve(payload: Uint8Array): void;
  reject(error: Error): void;
}

export class MspClient {
  firmware: Firmware = { variant: 'BTFL', api: [0, 0] };
  private readonly line: MspLine;
  private readonly reader = new FrameReader();
  private readonly endListening: () => void;
  private waiting: Waiting | null = null;
  private queue: Promise<unknown> = Promise.resolve();
  private dialog: CliDialog | null = null;
  private notifyCli: (() => void) | null = null;

  constructor(line: MspLine) {
    this.line = line;
    this.endListening = line.onData((data) => this.receive(data));
  }

  get hasCli(): boolean {
    return this.dialog !== null;
  }

  close(): void {
    this.endListening();
    this.waiting?.reject(new MspError('the connection was closed'));
    this.waiting = null;
    this.dialog = null;
  }

  /** Reads what the flight controller is; all layouts depend on it. */
  async identify(): Promise<Identity> {
    const api = await this.exchange(API_VERSION);
    const variant = text(await this.exchange(FC_VARIANT)).slice(0, 4);
    const version = await this.exchange(FC_VERSION);
    const board = text((await this.exchange(BOARD_INFO)).subarray(0, 4));
    if (!(variant in NAMES)) throw new MspError(`the firmware ${variant} is neither Betaflight nor iNav`);
    this.firmware = { variant: variant as Variant, api: [api[1] ?? 0, api[2] ?? 0] };
    const name = text(await this.exchange(NAME));
    const [major = 0, minor = 0, patch = 0] = version;
    const year = variant === 'BTFL' && major >= 25 ? major + 2000 : major;
    return {
      ...this.firmware,
      firmware: NAMES[variant]!,
      version: `${year}.${minor}.${patch}`,
      board,
      name: name.replace(/\0.*$/, ''),
    };
  }

  /** Returns whether the firmware has a message. */
  has(message: string): boolean {
    return messageFacts(message).variants.includes(this.firmware.variant);
  }

  /** Reads a message, such as `Pid`; `request` is the message that asks for it, where one has fields. */
  async get(
    message: string,
    request: { readonly name: string; readonly fields: MspFields } | null = null,
  ): Promise<MspFields> {
    const payload = request ? encodeMessage(request.name, request.fields, this.firmware) : new Uint8Array();
    return decodeMessage(message, await this.exchange(messageFacts(message).command, payload), this.firmware);
  }

  /** Writes a message, such as `SetPid`; nothing is saved by that. */
  async set(message: string, fields: MspFields): Promise<void> {
    await this.exchange(messageFacts(message).command, encodeMessage(message, fields, this.firmware));
  }

  /** Saves all settings, so that they outlast a restart. */
  async save(): Promise<void> {
    await this.exchange(EEPROM_WRITE, new Uint8Array(), SAVE_TIMEOUT);
  }

  async reboot(): Promise<void> {
    await this.exchange(REBOOT).catch((error: unknown) => {
      // Some versions restart before they answer.
      if (!(error instanceof MspError)) throw error;
    });
  }

  /** Sends a request, again where it is not answered; requests wait for one another. */
  exchange(command: number, payload: Uint8Array = new Uint8Array(), timeout = REPLY_TIMEOUT): Promise<Uint8Array> {
    const work = this.queue.then(() => this.ask(command, payload, timeout));
    this.queue = work.catch(() => undefined);
    return work;
  }

  private async ask(command: number, payload: Uint8Array, timeout: number): Promise<Uint8Array> {
    if (this.dialog !== null) throw new MspError('the command line is open: leave it first');
    for (let attempt = 0; attempt < ATTEMPTS; attempt += 1) {
      const reply = await this.attempt(command, payload, timeout);
      if (reply !== null) return reply;
    }
    throw new MspError(`command ${command} failed: no answer`);
  }

  private attempt(command: number, payload: Uint8Array, timeout: number): Promise<Uint8Array | null> {
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.waiting = null;
        resolve(null);
      }, timeout);
      this.waiting = {
        command,
        resolve: (reply) => {
          clearTimeout(timer);
          resolve(reply);
        },
        reject: (error) => {
          clearTimeout(timer);
          reject(error);
        },
      };
      this.line.send(encodeFrame(command, payload));
    });
  }

  private receive(data: Uint8Array): void {
    if (this.dialog !== null) {
      this.dialog.receive(data);
      this.notifyCli?.();
      return;
    }
    for (const frame of this.reader.feed(data)) this.take(frame);
  }

  private take({ command, payload, direction }: Frame): void {
    const { waiting } = this;
    if (waiting === null || waiting.command !== command || direction === '<') return;
    this.waiting = null;
    if (direction === '>') waiting.resolve(payload);
    else waiting.reject(new MspRefused(`command ${command} failed: the flight controller refused it`));
  }

  /** Sends a line to the CLI, which is opened first; resolves to its reply. */
  cli(line: string): Promise<string> {
    const work = this.queue.then(() => this.runLine(line));
    this.queue = work.catch(() => undefined);
    return work;
  }

  private async runLine(line: string): Promise<string> {
    if (this.dialog === null) await this.openCli();
    const dialog = this.dialog!;
    this.line.send(bytes(dialog.send(line)));
    if (isLeaving(line)) {
      // The firmware restarts, and speaks MSP again.
      this.dialog = this.notifyCli = null;
      return '';
    }
    return this.until(() => dialog.reply(), `the line ${line} failed: its reply did not end`);
  }

  private async openCli(): Promise<void> {
    const dialog = new CliDialog();
    this.dialog = dialog;
    this.line.send(bytes('#'));
    try {
      await delay(CLI_GUARD);
      await this.until(() => (dialog.atPrompt ? true : null), 'opening the command line failed: no prompt');
    } catch (error) {
      this.dialog = null;
      throw error;
    }
  }

  private until<Result>(found: () => Result | null, problem: string): Promise<Result> {
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new MspError(problem)), CLI_TIMEOUT);
      const look = (): void => {
        const result = found();
        if (result === null) return;
        clearTimeout(timer);
        this.notifyCli = null;
        resolve(result);
      };
      this.notifyCli = look;
      look();
    });
  }
}

const bytes = (line: string): Uint8Array => new TextEncoder().encode(line);
const text = (data: Uint8Array): string => new TextDecoder().decode(data);
const delay = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));
