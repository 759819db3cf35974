import { afterEach, expect, it, vi } from 'vitest';

import { tlogOf } from '$lib/series/export';
import { Encoder } from '$lib/decoder/Decoder';

import { fleet } from './fleet.svelte';
import { logIn, replay, startDemo, startReplay, startSerial, startServer } from './session';
import { status } from './status.svelte';

afterEach(() => {
  fleet.disconnect();
  vi.unstubAllGlobals();
});

it('stays where it is when no port is chosen', async () => {
  await startDemo(1);
  vi.stubGlobal('navigator', { serial: { requestPort: () => Promise.reject(new Error('No port selected')) } });
  await expect(startSerial()).rejects.toThrow('No port selected');
  expect([status.source, status.link]).toEqual(['demo', 'open']);
});

it('opens the port of the present link again, at another baud rate', async () => {
  const rates: number[] = [];
  let isOpen = false;
  const port = {
    readable: null,
    writable: {
      getWriter: () => ({
        write: () => Promise.resolve(),
        abort: () => Promise.resolve(),
        releaseLock: () => undefined,
      }),
    },
    getInfo: () => ({}),
    open: async ({ baudRate }: { baudRate: number }) => {
      if (isOpen) throw new Error('The port is already open.');
      isOpen = true;
      rates.push(baudRate);
    },
    close: async () => void (isOpen = false),
  };
  Object.defineProperty(port, 'readable', { get: () => (isOpen ? new ReadableStream() : null) });
  vi.stubGlobal('navigator', { serial: { requestPort: async () => port, getPorts: async () => [port] } });
  await startSerial(57_600);
  await startSerial(115_200);
  expect([rates, status.source, status.link]).toEqual([[57_600, 115_200], 'serial', 'open']);
});

it('stays where it is when a recording is empty', async () => {
  await startDemo(1);
  await expect(startReplay(new Uint8Array(100), 'empty.tlog')).rejects.toThrow(
    'replaying empty.tlog failed: the file has no packets',
  );
  expect(status.source).toBe('demo');
  expect(replay.current).toBeNull();
});

it('lets go of a recording when it is left', async () => {
  const bytes = new Encoder(1, 1).build('HEARTBEAT', { type: 2, autopilot: 3 });
  await startReplay(tlogOf([{ time: 1_790_000_000_000, bytes }]), 'flight.tlog');
  expect(replay.current?.packets).toBe(1);
  // No vehicle takes commands.
  expect(status.role).toBe('observe');
  await startDemo(1);
  expect(status.role).toBe('administer');
  expect(replay.current).toBeNull();
});

it('asks the station once while it waits for the password, which connects', async () => {
  vi.useFakeTimers();
  const asked: string[] = [];
  const sockets: string[] = [];
  const refused = { error: { kind: 'Unauthorized', text: 'a session is needed' } };
  const session = { role: 'operate', needs_password: true, ticket: 'abc' };
  const answer = (_url: string, { method = 'GET' }: RequestInit): Promise<Response> => {
    asked.push(method);
    const isKnown = asked.includes('POST');
    return Promise.resolve(new Response(JSON.stringify(isKnown ? session : refused), { status: isKnown ? 200 : 401 }));
  };
  vi.stubGlobal('fetch', answer);
  vi.stubGlobal('location', { href: 'http://station/' });
  vi.stubGlobal(
    'WebSocket',
    class {
      constructor(_url: string, protocols: string[]) {
        sockets.push(...protocols);
      }
      close(): void {}
    },
  );
  void startServer();
  await vi.advanceTimersByTimeAsync(60_000);
  expect([asked, sockets, status.needsLogin, status.link]).toEqual([['GET'], [], true, 'connecting']);
  void logIn('fly it carefully');
  await vi.advanceTimersByTimeAsync(0);
  expect([asked, sockets, status.needsLogin, status.role]).toEqual([
    ['GET', 'POST', 'GET'],
    ['ados-ws-ticket', 'abc', 'mavstack.raw.1'],
    false,
    'operate',
  ]);
  vi.useRealTimers();
});
