import { expect, it } from 'vitest';

import { ApiClient } from '$lib/api/client';

import { otherLog, telemetryOf } from './replays';

const ascii = (text: string): Uint8Array => new TextEncoder().encode(text);
const dataflash = Uint8Array.from([0xa3, 0x95, 0x80, 0x80, 89]);

it('knows logs that are not telemetry logs by their beginning', () => {
  const found = [
    dataflash,
    ascii('ULog\u0001'),
    ascii('H Product:Blackbox'),
    Uint8Array.from([0xd4, 0xc3, 0xb2, 0xa1]),
    ascii('FMT, 128'),
  ].map(otherLog);
  expect(found.every((each) => each !== null)).toBe(true);
  expect(otherLog(Uint8Array.from([0, 5, 0x65, 0, 0, 0, 0, 0, 0xfd]))).toBeNull();
  expect(otherLog(new Uint8Array())).toBeNull();
});

it('has the station make a telemetry log of them', async () => {
  const calls: string[] = [];
  const fetcher = (url: string, init: RequestInit): Promise<Response> => {
    calls.push(`${init.method} ${url} ${(init.body as Blob).size}`);
    return Promise.resolve(new Response(Uint8Array.from([1, 2, 3])));
  };
  const api = new ApiClient('/api', fetcher as typeof fetch);
  const tlog = Uint8Array.from([0, 5, 0x65, 0]);
  expect(await telemetryOf(tlog, 'flight.tlog', api)).toBe(tlog);
  expect([...(await telemetryOf(dataflash, '/Flüge 7.BIN', api))]).toEqual([1, 2, 3]);
  expect(calls).toEqual(['POST /api/replays?name=_Fl_ge+7.BIN&wait=false 5']);
});

it('refuses them in words where there is no station, and gives the reasons of one', async () => {
  const gone = new ApiClient('/api', () => Promise.reject(new Error('x')));
  await expect(telemetryOf(dataflash, 'a.BIN', gone)).rejects.toThrow(
    'replaying a.BIN failed: it is an onboard log of ArduPilot, which only a station can replay (the station ' +
      'does not answer)',
  );
  const answer = JSON.stringify({ error: { kind: 'LogError', text: 'replaying a.BIN failed: it has no positions' } });
  const refusing = new ApiClient('/api', () => Promise.resolve(new Response(answer, { status: 400 })));
  await expect(telemetryOf(dataflash, 'a.BIN', refusing)).rejects.toThrow(
    'replaying a.BIN failed: it has no positions',
  );
});
