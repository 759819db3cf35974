import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { Decoder, Encoder } from '$lib/decoder/Decoder';
import { FLEET } from '$lib/transport/mock/profiles';

import { LinkVehicle } from './LinkVehicle';
import { startFlight } from './testing';

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

it('points at a place at the altitude of home, and moves home', async () => {
  const flight = await startFlight([FLEET[0]!]);
  const { vehicle, transport } = flight;
  await flight.pass(6);
  const home = vehicle.state.home!;
  const place = { latitude: home.latitude + 0.001, longitude: home.longitude };
  const [mock] = transport.vehicles;
  await flight.until(vehicle.lookAt(place));
  expect(mock!.autopilot.lookedAt?.north).toBeCloseTo(mock!.autopilot.home.north + 111, 0);
  expect(mock!.autopilot.lookedAt?.up).toBeCloseTo(mock!.autopilot.home.up, 1);
  await flight.until(vehicle.lookAt(null));
  expect(mock!.autopilot.lookedAt).toBeNull();
  await flight.until(vehicle.setHome(place));
  await flight.pass(1);
  expect(vehicle.state.home?.latitude).toBeCloseTo(place.latitude, 6);
  expect(vehicle.state.home?.altitude).toBeCloseTo(home.altitude!, 1);
  expect([vehicle.capabilities.roi, vehicle.capabilities.home]).toEqual([true, true]);
});

it('tells PX4 altitudes above the sea', () => {
  const sent: [string, object][] = [];
  const [encoder, decoder] = [new Encoder(1, 1), new Decoder()];
  const decoded = (name: string, fields: Parameters<Encoder['build']>[1]) =>
    decoder.push(encoder.build(name, fields))[0]!;
  const heartbeat = decoded('HEARTBEAT', { type: 2, autopilot: 12 });
  const vehicle = new LinkVehicle(heartbeat, (name, fields) => sent.push([name, fields]));
  vehicle.take(heartbeat);
  vehicle.take(decoded('HOME_POSITION', { latitude: 47e7, longitude: 8e7, altitude: 500_000 }));
  vehicle.publish(Date.now());
  const place = { latitude: 47.001, longitude: 8 };
  vehicle.lookAt(place, 10).catch(() => undefined);
  expect(sent.at(-1)).toMatchObject(['COMMAND_INT', { command: 195, frame: 0, x: 470_010_000, y: 80_000_000, z: 510 }]);
  vehicle.setHome(place).catch(() => undefined);
  expect(sent.at(-1)).toMatchObject(['COMMAND_INT', { command: 179, frame: 0, param1: 0, z: 500 }]);
  vehicle.dispose();
});
