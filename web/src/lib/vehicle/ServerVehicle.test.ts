import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { ApiClient } from '$lib/api/client';
import { Decoder, Encoder } from '$lib/decoder/Decoder';

import { ServerVehicle } from './ServerVehicle';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const heartbeat = new Decoder().push(new Encoder(1, 1).build('HEARTBEAT', { type: 2, autopilot: 3 }))[0]!;

function vehicleOf(answer: () => object): { vehicle: ServerVehicle; calls: string[] } {
  const calls: string[] = [];
  const fetcher = (url: string, init: RequestInit): Promise<Response> => {
    calls.push(`${init.method} ${url}`);
    return Promise.resolve(new Response(JSON.stringify(answer())));
  };
  return { vehicle: new ServerVehicle(heartbeat, () => {}, new ApiClient('/api', fetcher as typeof fetch)), calls };
}

it('has the capabilities that the server tells, also those that are not known yet', async () => {
  const given = { orbit: false, osd: null, fence: false, motor_test: false, calibrations: ['compass'], cameras: [100] };
  const { vehicle } = vehicleOf(() => ({ capabilities: given }));
  expect(vehicle.capabilities).toMatchObject({ orbit: true, motorTest: true });
  await vi.advanceTimersByTimeAsync(0);
  const { orbit, osd, fence, motorTest, mission, calibration, cameras, gimbals } = vehicle.capabilities;
  expect([orbit, osd, fence, motorTest, mission]).toEqual([false, null, false, false, null]);
  expect([calibration, cameras, gimbals]).toEqual([['compass'], [100], []]);
  vehicle.dispose();
});

it('points at places and moves home by the API', async () => {
  const { vehicle, calls } = vehicleOf(() => ({ capabilities: {} }));
  const place = { latitude: 47, longitude: 8 };
  await vehicle.lookAt(place);
  await vehicle.lookAt(null);
  await vehicle.setHome(place);
  vehicle.dispose();
  expect(calls.slice(1)).toEqual(['roi', 'roi/clear', 'home'].map((path) => `POST /api/vehicles/1/${path}?accepted=true`));
});

it('asks for them again, until it is left', async () => {
  const { vehicle, calls } = vehicleOf(() => ({ capabilities: {} }));
  await vi.advanceTimersByTimeAsync(60_000);
  expect(calls).toEqual(new Array(4).fill('GET /api/vehicles/1'));
  const left = vehicleOf(() => ({ capabilities: {} }));
  await vi.advanceTimersByTimeAsync(2500);
  left.vehicle.dispose();
  await vi.advanceTimersByTimeAsync(60_000);
  expect(left.calls).toHaveLength(2);
  vehicle.dispose();
});

it('writes names of parameters so that they are no part of the path', async () => {
  const { vehicle, calls } = vehicleOf(() => ({}));
  await vehicle.setParameter('../arm?x', 1);
  await vehicle.pauseMission();
  expect(calls.slice(1)).toEqual([
    'PUT /api/vehicles/1/parameters/..%2Farm%3Fx',
    'POST /api/vehicles/1/mission/pause?accepted=true',
  ]);
  vehicle.dispose();
});
