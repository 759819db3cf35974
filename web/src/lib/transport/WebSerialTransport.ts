/** A flight controller at a serial port, by the browser's WebSerial; opens it again when it was plugged in again. */

import { StationError } from '$lib/api/errors';

import { BaseTransport } from './Transport';

/** The parts of WebSerial that are used; TypeScript's own types lack it. */
export interface SerialPort {
  readonly readable: ReadableStream<Uint8Array> | null;
  readonly writable: WritableStream<Uint8Array> | null;
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  getInfo(): { usbVendorId?: number; usbProductId?: number };
}

interface Serial {
  requestPort(): Promise<SerialPort>;
  /** Returns the ports that the user has allowed and that are plugged in. */
  getPorts(): Promise<SerialPort[]>;
}

export const DEFAULT_BAUD_RATE = 115_200;
export const BAUD_RATES: readonly number[] = [9600, 57_600, 115_200, 230_400, 460_800, 500_000, 921_600, 1_500_000];
/** Interval in ms in which a port that was unplugged is looked for. */
const RETRY_INTERVAL = 1000;
/** Bytes that may wait for a slow port: sticks must not arrive late. */
const MAX_BACKLOG = 4096;

/** Whether the browser has WebSerial: Chromium and its relatives, on secure pages. */
export function hasSerial(): boolean {
  return typeof navigator !== 'undefined' && 'serial' in navigator;
}

const serial = (): Serial => (navigator as unknown as { serial: Serial }).serial;

export class WebSerialTransport extends BaseTransport {
  name = 'USB';
  private readonly baudRate: number;
  private port: SerialPort | null = null;
  private reader: ReadableStreamDefaultReader<Uint8Array> | null = null;
  private writer: WritableStreamDefaultWriter<Uint8Array> | null = null;
  private timer: ReturnType<typeof setInterval> | null = null;
  private isOpening = false;
  private isWanted = false;
  private backlog = 0;
  private released: Promise<void> = Promise.resolve();

  constructor(baudRate = DEFAULT_BAUD_RATE) {
    super();
    this.baudRate = baudRate;
  }

  /** Lets the user choose a port; must be called from a click. */
  async choose(): Promise<void> {
    this.port = await serial().requestPort();
    this.name = nameOf(this.port);
  }

  /** Whether it has the port that another transport was given. */
  shares(other: WebSerialTransport): boolean {
    return this.port !== null && this.port === other.port;
  }

  /** Opens the port, which the user chooses if he has not; then it must be called from a click. */
  async open(): Promise<void> {
    if (this.state === 'open') return;
    this.change('connecting');
    try {
      if (this.port === null) await this.choose();
      await this.openPort(this.port!);
    } catch (error) {
      this.change('failed', error instanceof Error ? error.message : String(error));
      throw error;
    }
    this.isWanted = true;
  }

  close(): void {
    this.isWanted = false;
    this.stopLooking();
    this.release();
    this.change('closed');
  }

  /** Resolves when another program, page or transport can open the port. */
  get closed(): Promise<void> {
    return this.released;
  }

  send(packets: Uint8Array): void {
    const { writer } = this;
    if (writer === null || this.backlog + packets.length > MAX_BACKLOG) return;
    this.backlog += packets.length;
    writer.write(packets).then(
      () => (this.backlog -= packets.length),
      () => {
        if (this.writer === writer) this.lose('the port takes no data');
      },
    );
  }

  private async openPort(port: SerialPort): Promise<void> {
    try {
      await port.open({ baudRate: this.baudRate });
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      const hint = 'another page or program may have it open';
      throw new StationError('SerialError', `opening ${this.name} failed: ${hint} (${reason})`);
    }
    this.port = port;
    this.writer = port.writable?.getWriter() ?? null;
    this.backlog = 0;
    this.change('open');
    void this.read(port);
  }

  private async read(port: SerialPort): Promise<void> {
    // Noise on the line ends the stream, and the port has a new one; a port that is gone has none.
    while (this.port === port && this.state === 'open' && port.readable !== null) {
      const reader = port.readable.getReader();
      this.reader = reader;
      try {
        for (;;) {
          const { value, done } = await reader.read();
          if (done) break;
          if (this.reader === reader) this.emit(value);
        }
      } catch {
        // Told by `readable`.
      } finally {
        reader.releaseLock();
      }
      if (this.reader !== reader) return;
      this.reader = null;
    }
    if (this.port === port && this.state === 'open') this.lose('the port was unplugged');
  }

  private lose(reason: string): void {
    this.release();
    this.change('failed', reason);
    if (this.isWanted) this.timer ??= setInterval(() => void this.reopen(), RETRY_INTERVAL);
  }

  /** Opens the port again once it is there; a flight controller that restarts comes back as a new port. */
  private async reopen(): Promise<void> {
    if (this.isOpening || !this.isWanted) return;
    this.isOpening = true;
    try {
      await this.released;
      const ports = await serial().getPorts();
      const port = ports.find((each) => each === this.port) ?? ports.find((each) => nameOf(each) === this.name);
      if (port !== undefined && this.isWanted) await this.openPort(port);
    } catch {
      // It is tried again.
    } finally {
      this.isOpening = false;
    }
    if (this.state === 'open') this.stopLooking();
    if (!this.isWanted) this.release();
  }

  private stopLooking(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }

  /** Lets go of the port's streams, which must be free when it is closed. */
  private release(): void {
    const { port, reader, writer } = this;
    if (writer === null && reader === null) return;
    this.reader = this.writer = null;
    this.released = (async () => {
      await reader?.cancel().catch(() => undefined);
      await writer?.abort().catch(() => undefined);
      writer?.releaseLock();
      await port?.close().catch(() => undefined);
    })();
  }
}

function nameOf(port: SerialPort): string {
  const { usbVendorId, usbProductId } = port.getInfo();
  const hex = (id?: number): string => (id ?? 0).toString(16).padStart(4, '0');
  return usbVendorId === undefined ? 'serial port' : `USB ${hex(usbVendorId)}:${hex(usbProductId)}`;
}
