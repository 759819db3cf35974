import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { LinkTransport, parseLink } from './LinkTransport';

const TICKET = `room1.boat.guest.1900000000.${'a'.repeat(64)}`;
const SECRET = '5a'.repeat(32);

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test('addresses of vehicles, with a ticket or a token, and their names without them', () => {
  expect(parseLink(' wss://drone.example/mavlink?ticket=v2.x ')).toEqual({
    name: 'wss://drone.example/mavlink',
    url: 'wss://drone.example/mavlink',
    protocols: ['ados-ws-ticket', 'v2.x'],
    secret: null,
  });
  const plain = parseLink('ws://127.0.0.1:5770?token=secret word'.replace(' ', '+'));
  expect([plain.name, plain.url]).toEqual(['ws://127.0.0.1:5770', 'ws://127.0.0.1:5770/?access_token=secret+word']);
});

test('the address of a room', () => {
  const room = parseLink(`relay://relay.example:7070/?ticket=${TICKET}&secret=${SECRET}`);
  expect(room.url).toBe('wss://relay.example:7070/');
  expect(room.protocols).toEqual(['mavstack.relay.1', TICKET]);
  expect(room.secret).toEqual(new Uint8Array(32).fill(0x5a));
  expect(room.name).toBe('relay://relay.example:7070');
  expect(parseLink(`relay://127.0.0.1:7070?tls=no&ticket=${TICKET}&secret=${SECRET}`).url).toBe('ws://127.0.0.1:7070/');
});

test.each([
  ['http://drone.example', /must begin with/],
  ['javascript:alert(1)', /must begin with/],
  ['wss://', /must begin with/],
  ['wss://:99999', /not followed by a host/],
  [`relay://relay.example?secret=${SECRET}`, /no ticket/],
  [`relay://relay.example?ticket=${TICKET.replace('guest', 'host')}&secret=${SECRET}`, /second URL/],
  [`relay://relay.example?ticket=${TICKET}&secret=5a`, /no secret/],
])('%s is refused', (text, reason) => {
  expect(() => parseLink(text)).toThrow(reason);
});

class Socket {
  static made: Socket[] = [];
  readyState = 1;
  bufferedAmount = 0;
  binaryType = '';
  sent: Uint8Array[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: ArrayBuffer | string }) => void) | null = null;
  onclose: ((event: { reason: string }) => void) | null = null;
  constructor() {
    Socket.made.push(this);
  }
  send(data: Uint8Array): void {
    this.sent.push(data);
  }
  close(): void {
    this.readyState = 3;
  }
}

function transportTo(text: string): LinkTransport {
  Socket.made = [];
  return new LinkTransport(parseLink(text), () => new Socket() as unknown as WebSocket);
}

test('packets go both ways, and a lost connection is made again', async () => {
  const transport = transportTo('ws://127.0.0.1:5770');
  const received: Uint8Array[] = [];
  transport.onData((data) => received.push(data));
  await transport.open();
  Socket.made[0]!.onopen!();
  expect(transport.state).toBe('open');
  transport.send(Uint8Array.of(1));
  Socket.made[0]!.onmessage!({ data: Uint8Array.of(2).buffer });
  Socket.made[0]!.onmessage!({ data: 'text' });
  expect([Socket.made[0]!.sent, received]).toEqual([[Uint8Array.of(1)], [Uint8Array.of(2)]]);
  Socket.made[0]!.onclose!({ reason: 'gone' });
  expect([transport.state, transport.reason]).toEqual(['failed', 'gone']);
  vi.advanceTimersByTime(500);
  expect(Socket.made.length).toBe(2);
  transport.close();
  vi.advanceTimersByTime(60_000);
  expect(Socket.made.length).toBe(2);
});

test('over a relay nothing is sent in the clear, and the link is open only after the handshake', async () => {
  const transport = transportTo(`relay://127.0.0.1:7070?tls=no&ticket=${TICKET}&secret=${SECRET}`);
  const received: Uint8Array[] = [];
  transport.onData((data) => received.push(data));
  await transport.open();
  const [socket] = Socket.made;
  socket!.onopen!();
  transport.send(Uint8Array.of(0xfd, 1, 2, 3));
  socket!.onmessage!({ data: Uint8Array.of(0xfd, 1, 2, 3).buffer });
  vi.advanceTimersByTime(3000);
  expect(transport.state).toBe('connecting');
  expect(received).toEqual([]);
  expect(socket!.sent.length).toBeGreaterThan(1);
  expect(socket!.sent.every((message) => message[0] === 1 && message.length === 25)).toBe(true);
  transport.close();
});
