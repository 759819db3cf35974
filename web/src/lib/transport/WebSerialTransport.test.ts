import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { WebSerialTransport, type SerialPort } from './WebSerialTransport';

/** A port with real streams, which are locked and end as those of a browser. */
class FakePort implements SerialPort {
  readable: ReadableStream<Uint8Array> | null = null;
  writable: WritableStream<Uint8Array> | null = null;
  readonly written: number[] = [];
  isBusy = false;
  isStalled = false;
  baudRate = 0;
  private source: ReadableStreamDefaultController<Uint8Array> | null = null;
  private readonly ids: { usbVendorId?: number; usbProductId?: number };

  constructor(ids: { usbVendorId?: number; usbProductId?: number } = { usbVendorId: 0x26ac, usbProductId: 0x11 }) {
    this.ids = ids;
  }

  async open({ baudRate }: { baudRate: number }): Promise<void> {
    if (this.isBusy) throw new Error('Failed to open serial port.');
    if (this.readable !== null) throw new Error('The port is already open.');
    this.baudRate = baudRate;
    this.renew();
    const write = (data: Uint8Array): Promise<void> | void => {
      if (this.isStalled) return new Promise(() => undefined);
      this.written.push(...data);
    };
    this.writable = new WritableStream({ write });
  }

  /** Gives the port a new stream, as browsers do after noise on the line. */
  renew(): void {
    this.readable = new ReadableStream({ start: (source) => void (this.source = source) });
  }

  async close(): Promise<void> {
    if (this.readable?.locked === true || this.writable?.locked === true) throw new TypeError('locked');
    this.readable = this.writable = null;
  }

  getInfo(): { usbVendorId?: number; usbProductId?: number } {
    return this.ids;
  }

  give(...bytes: number[]): void {
    this.source!.enqueue(new Uint8Array(bytes));
  }

  noise(): void {
    const broken = this.source!;
    this.renew();
    broken.error(new Error('A buffer overrun has been detected.'));
  }

  unplug(): void {
    this.readable = null;
    this.source!.error(new Error('The device has been lost.'));
  }
}

let plugged: FakePort[];
let port: FakePort;

beforeEach(() => {
  vi.useFakeTimers();
  port = new FakePort();
  plugged = [port];
  vi.stubGlobal('navigator', { serial: { requestPort: async () => port, getPorts: async () => plugged } });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

async function opened(baudRate?: number): Promise<{ transport: WebSerialTransport; received: number[] }> {
  const transport = new WebSerialTransport(baudRate);
  const received: number[] = [];
  transport.onData((data) => received.push(...data));
  await transport.open();
  return { transport, received };
}

const settle = (time = 0): Promise<unknown> => vi.advanceTimersByTimeAsync(time);

it('reads and writes at the baud rate that was chosen', async () => {
  const { transport, received } = await opened(57_600);
  port.give(1, 2);
  port.give(3);
  transport.send(new Uint8Array([9, 8]));
  await settle();
  expect([transport.name, port.baudRate]).toEqual(['USB 26ac:0011', 57_600]);
  expect([received, port.written]).toEqual([
    [1, 2, 3],
    [9, 8],
  ]);
});

it('goes on after noise on the line', async () => {
  const { transport, received } = await opened();
  port.give(1);
  await settle();
  port.noise();
  await settle();
  port.give(2);
  await settle();
  expect([transport.state, received]).toEqual(['open', [1, 2]]);
});

it('opens the port again when it was plugged in again, as the same port or as a new one', async () => {
  const { transport, received } = await opened();
  for (const next of [port, new FakePort()]) {
    plugged[0]!.unplug();
    plugged = [];
    await settle(2500);
    expect([transport.state, transport.reason]).toEqual(['failed', 'the port was unplugged']);
    transport.send(new Uint8Array([5]));
    plugged = [new FakePort({ usbVendorId: 1, usbProductId: 2 }), next];
    await settle(1100);
    expect(transport.state).toBe('open');
    received.length = 0;
    next.give(7);
    await settle();
    expect([received, next.written]).toEqual([[7], []]);
    plugged = [next];
  }
});

it('frees the port when it is closed, and looks for it no longer', async () => {
  const { transport, received } = await opened();
  transport.close();
  await transport.closed;
  expect([transport.state, port.readable]).toEqual(['closed', null]);
  const again = await opened();
  port.give(4);
  await settle();
  expect([received, again.received]).toEqual([[], [4]]);
  port.unplug();
  await settle();
  again.transport.close();
  await settle(5000);
  expect([again.transport.state, port.readable]).toEqual(['closed', null]);
});

it('tells that the port is in use', async () => {
  port.isBusy = true;
  const reason = 'opening USB 26ac:0011 failed: another page or program may have it open (Failed to open serial port.)';
  await expect(opened()).rejects.toThrow(reason);
});

it('drops what a port that is stalled cannot take', async () => {
  const { transport } = await opened();
  port.isStalled = true;
  for (let count = 0; count < 1000; count += 1) transport.send(new Uint8Array(30));
  port.isStalled = false;
  transport.close();
  await settle();
  expect(transport.state).toBe('closed');
  expect(Reflect.get(transport, 'backlog')).toBeLessThanOrEqual(4096);
});
