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
  expect(calls.slice(1)).toEqual(
    ['roi', 'roi/clear', 'home'].map((path) => `POST /api/vehicles/1/${path}?accepted=true`),
  );
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

it('shows the texts that the vehicle sent before the page was opened, once and by the clock of the page', async () => {
  vi.setSystemTime(1_790_000_100_000);
  const text = (time: number, words: string, severity: string | number = 'WARNING') => ({
    time,
    severity,
    text: words,
    component: 1,
  });
  // The clock of the station is an hour ahead.
  const kept = [text(3590, 'Compass calibrated', 'INFO'), text(3598, 'PreArm: GPS'), text(3599.9, 'EKF3 active', 6)];
  const { vehicle } = vehicleOf(() => ({ capabilities: {}, time: 3600, status_texts: kept }));
  const [live] = new Decoder().push(
    new Encoder(1, 1).build('STATUSTEXT', { severity: 6, text: 'EKF3 active' }),
    Date.now(),
  );
  vehicle.take(live!);
  await vi.advanceTimersByTimeAsync(0);
  vehicle.publish(Date.now());
  expect(
    vehicle.state.statusTexts.map(({ text: words, severity, time }) => [words, severity, Date.now() - time]),
  ).toEqual([
    ['Compass calibrated', 6, 10_000],
    ['PreArm: GPS', 4, 2000],
    ['EKF3 active', 6, 0],
  ]);
  expect(vehicle.takeLearned().map((each) => each.text)).toEqual(['Compass calibrated', 'PreArm: GPS']);
  await vi.advanceTimersByTimeAsync(2000);
  vehicle.publish(Date.now());
  expect([vehicle.takeLearned(), vehicle.state.statusTexts.length]).toEqual([[], 3]);
  vehicle.dispose();
});

const CONFLICT = {
  text: 'two vehicles use system id 1',
  differs: ['position'],
  chosen: null,
  senders: [
    {
      channel: 'udpin 127.0.0.1:4001',
      type: 'quadrotor with ArduPilot',
      unique_id: 'ab',
      position: null,
      chosen: false,
    },
    { channel: 'udpin 127.0.0.1:4002', type: 'rover with ArduPilot', unique_id: null, position: null, chosen: false },
  ],
};

it('acts on neither of two vehicles with its id, until one is chosen', async () => {
  const sent: string[] = [];
  const calls: string[] = [];
  let chosen: string | null = null;
  const fetcher = (url: string, init: RequestInit): Promise<Response> => {
    calls.push(`${init.method} ${url}`);
    if (url.endsWith('sender')) chosen = (JSON.parse(String(init.body)) as { channel: string }).channel;
    return Promise.resolve(
      new Response(JSON.stringify({ capabilities: {}, id: 2, conflict: { ...CONFLICT, chosen } })),
    );
  };
  const vehicle = new ServerVehicle(
    heartbeat,
    (name) => void sent.push(name),
    new ApiClient('/api', fetcher as typeof fetch),
  );
  await vi.advanceTimersByTimeAsync(0);
  vehicle.publish(Date.now());
  expect(vehicle.state.conflict?.senders.map((each) => each.uniqueId)).toEqual(['ab', null]);
  calls.length = 0;
  const plan = { items: [], home: null };
  const acts = [
    () => vehicle.arm(),
    () => vehicle.takeoff(5),
    () => vehicle.setMode('RTL'),
    () => vehicle.sendCommand('DO_SET_MODE'),
    () => vehicle.setParameter('RTL_ALT', 1),
    () => vehicle.uploadPlan('mission', plan),
    () => vehicle.clearPlan('mission'),
  ];
  for (const act of acts) await expect(act()).rejects.toMatchObject({ kind: 'SystemIdConflictError' });
  vehicle.sendMessage('MANUAL_CONTROL', {});
  vehicle.sendMessage('PARAM_REQUEST_LIST', {});
  expect([calls, sent]).toEqual([[], ['PARAM_REQUEST_LIST']]);
  await vehicle.chooseSender('udpin 127.0.0.1:4002');
  await vehicle.arm();
  vehicle.sendMessage('MANUAL_CONTROL', {});
  expect(calls).toEqual(['POST /api/vehicles/1/sender', 'POST /api/vehicles/1/arm?accepted=true']);
  expect(sent).toEqual(['PARAM_REQUEST_LIST', 'MANUAL_CONTROL']);
  expect(await vehicle.renumber('udpin 127.0.0.1:4002')).toBe(2);
  vehicle.dispose();
});
