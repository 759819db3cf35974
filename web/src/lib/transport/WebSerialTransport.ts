/** A flight controller at a serial port, by the browser's WebSerial. */

import { BaseTransport } from './Transport';

/** The parts of WebSerial that are used; TypeScript's own types lack it. */
interface SerialPort {
  readonly readable: ReadableStream<Uint8Array> | null;
  readonly writable: WritableStream<Uint8Array> | null;
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  getInfo(): { usbVendorId?: number; usbProductId?: number };
}

interface Serial {
  requestPort(): Promise<SerialPort>;
}

/** Whether the browser has WebSerial: Chromium and its relatives, on secure pages. */
export function hasSerial(): boolean {
  return typeof navigator !== 'undefined' && 'serial' in navigator;
}

export class WebSerialTransport extends BaseTransport {
  name = 'USB';
  private readonly baudRate: number;
  private port: SerialPort | null = null;
  private reader: ReadableStreamDefaultReader<Uint8Array> | null = null;
  private writer: WritableStreamDefaultWriter<Uint8Array> | null = null;

  constructor(baudRate = 115_200) {
    super();
    this.baudRate = baudRate;
  }

  /** Lets the user choose a port; must be called from a click. */
  async open(): Promise<void> {
    if (this.state === 'open') return;
    this.change('connecting');
    try {
      const port = await (navigator as unknown as { serial: Serial }).serial.requestPort();
      await port.open({ baudRate: this.baudRate });
      const { usbVendorId, usbProductId } = port.getInfo();
      const hex = (id?: number): string => (id ?? 0).toString(16).padStart(4, '0');
      this.name = usbVendorId === undefined ? 'serial port' : `USB ${hex(usbVendorId)}:${hex(usbProductId)}`;
      this.port = port;
    } catch (error) {
      const reason = error instanceof Error ? error.message : String(error);
      this.change('failed', reason);
      throw error;
    }
    this.writer = this.port.writable?.getWriter() ?? null;
    this.change('open');
    void this.read(this.port);
  }

  close(): void {
    const [port, reader, writer] = [this.port, this.reader, this.writer];
    this.port = this.reader = this.writer = null;
    this.change('closed');
    void (async () => {
      await reader?.cancel().catch(() => undefined);
      writer?.releaseLock();
      await port?.close().catch(() => undefined);
    })();
  }

  send(packets: Uint8Array): void {
    this.writer?.write(packets).catch(() => this.lose('the port does not take data'));
  }

  private async read(port: SerialPort): Promise<void> {
    const reader = port.readable?.getReader();
    if (reader === undefined) return;
    this.reader = reader;
    try {
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        this.emit(value);
      }
    } catch {
      this.lose('the port was unplugged');
    } finally {
      reader.releaseLock();
    }
  }

  private lose(reason: string): void {
    if (this.port === null) return;
    this.close();
    this.change('failed', reason);
  }
}
