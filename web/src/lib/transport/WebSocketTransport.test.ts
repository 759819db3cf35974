import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { WebSocketTransport, stationSocket } from './WebSocketTransport';

class FakeSocket {
  static readonly made: FakeSocket[] = [];
  binaryType = '';
  readyState = 0;
  bufferedAmount = 0;
  readonly sent: unknown[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { reason: string }) => void) | null = null;

  readonly protocols: string[];

  constructor(protocols: string[]) {
    this.protocols = protocols;
    FakeSocket.made.push(this);
  }

  accept(): void {
    this.readyState = 1;
    this.onopen?.();
  }

  drop(reason = ''): void {
    this.readyState = 3;
    this.onclose?.({ reason });
  }

  send(data: unknown): void {
    this.sent.push(data);
  }

  close(): void {
    this.drop();
  }
}

const makeSocket = (_url: string, protocols: string[]): WebSocket => new FakeSocket(protocols) as unknown as WebSocket;

beforeEach(() => {
  vi.useFakeTimers();
  FakeSocket.made.length = 0;
});
afterEach(() => vi.useRealTimers());

describe('WebSocketTransport', () => {
  it('passes bytes in both directions while it is open', async () => {
    const transport = new WebSocketTransport('ws://x/ws', { makeSocket });
    const received: number[] = [];
    transport.onData((data) => received.push(...data));
    transport.send(Uint8Array.of(9));
    const opening = transport.open();
    await vi.advanceTimersByTimeAsync(0);
    const [socket] = FakeSocket.made;
    socket!.accept();
    await opening;
    expect([transport.state, socket!.protocols]).toEqual(['open', ['mavstack.raw.1']]);
    socket!.onmessage?.({ data: Uint8Array.of(1, 2).buffer });
    transport.send(Uint8Array.of(3));
    expect([received, socket!.sent.length]).toEqual([[1, 2], 1]);
  });

  it('reconnects with growing pauses and a new ticket each time', async () => {
    let count = 0;
    const ticket = (): Promise<string> => Promise.resolve(`ticket ${(count += 1)}`);
    const transport = new WebSocketTransport('ws://x/ws', { makeSocket, ticket });
    const states: string[] = [];
    transport.onState((state) => states.push(state));
    void transport.open();
    await vi.advanceTimersByTimeAsync(0);
    FakeSocket.made[0]!.accept();
    FakeSocket.made[0]!.drop('restart');
    expect([transport.state, transport.reason]).toEqual(['failed', 'restart']);
    await vi.advanceTimersByTimeAsync(500);
    FakeSocket.made[1]!.drop();
    await vi.advanceTimersByTimeAsync(999);
    expect(FakeSocket.made).toHaveLength(2);
    await vi.advanceTimersByTimeAsync(1);
    FakeSocket.made[2]!.accept();
    expect(FakeSocket.made[2]!.protocols).toEqual(['ados-ws-ticket', 'ticket 3', 'mavstack.raw.1']);
    expect(states).toEqual(['connecting', 'open', 'failed', 'connecting', 'failed', 'connecting', 'open']);
  });

  it('drops what a stalled connection would deliver late', async () => {
    const transport = new WebSocketTransport('ws://x/ws', { makeSocket });
    void transport.open();
    await vi.advanceTimersByTimeAsync(0);
    const socket = FakeSocket.made[0]!;
    socket.accept();
    socket.bufferedAmount = 5000;
    transport.send(Uint8Array.of(1));
    expect(socket.sent).toEqual([]);
    socket.bufferedAmount = 100;
    transport.send(Uint8Array.of(2));
    expect(socket.sent).toHaveLength(1);
  });

  it('ends the wait for a connection when it is closed', async () => {
    const transport = new WebSocketTransport('ws://x/ws', { makeSocket });
    const opening = transport.open();
    await vi.advanceTimersByTimeAsync(0);
    transport.close();
    await expect(opening).resolves.toBeUndefined();
    expect(transport.state).toBe('closed');
  });

  it('stays closed once it was closed', async () => {
    const transport = new WebSocketTransport('ws://x/ws', { makeSocket });
    void transport.open();
    await vi.advanceTimersByTimeAsync(0);
    transport.close();
    await vi.advanceTimersByTimeAsync(60_000);
    expect([transport.state, FakeSocket.made.length]).toEqual(['closed', 1]);
  });
});

describe('stationSocket', () => {
  it('is beside the page, with its security', () => {
    expect(stationSocket('https://host:8443/station/?demo#/fly')).toBe('wss://host:8443/station/ws');
    expect(stationSocket('http://127.0.0.1:8080/')).toBe('ws://127.0.0.1:8080/ws');
  });
});
