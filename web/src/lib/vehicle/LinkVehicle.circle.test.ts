import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { Decoder, Encoder } from '$lib/decoder/Decoder';
import { distance, type Place } from '$lib/map/geometry';
import { FLEET } from '$lib/transport/mock/profiles';

import { startFlight, type Flight } from './testing';

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

const [COPTER, , PLANE, ROVER] = FLEET;

async function inFlight(): Promise<Flight> {
  const flight = await startFlight([COPTER!]);
  await flight.until(flight.vehicle.setMode('GUIDED'));
  await flight.until(flight.vehicle.arm());
  await flight.until(flight.vehicle.takeoff(10));
  await flight.pass(10);
  return flight;
}

/** Returns the distances to a place in each of some seconds, and the degrees that the bearing to it turned by. */
async function watch(
  { vehicle, pass }: Flight,
  center: Place,
  seconds: number,
): Promise<{ distances: number[]; turned: number }> {
  const distances: number[] = [];
  let turned = 0;
  const angle = (): number => {
    const { latitude, longitude } = vehicle.state.position!;
    return (
      (Math.atan2((longitude - center.longitude) * Math.cos((latitude * Math.PI) / 180), latitude - center.latitude) *
        180) /
      Math.PI
    );
  };
  let last = angle();
  for (let second = 0; second < seconds; second += 1) {
    await pass(1);
    distances.push(distance(vehicle.state.position!, center));
    turned += ((angle() - last + 540) % 360) - 180;
    last = angle();
  }
  return { distances, turned };
}

it.each([15, -15])('circles a place with a copter at a radius of %i m', async (radius) => {
  const flight = await inFlight();
  const { vehicle } = flight;
  expect(vehicle.capabilities.orbit).toBe(true);
  const { latitude, longitude } = vehicle.state.position!;
  const center = { latitude: latitude + 0.0005, longitude };
  await flight.until(vehicle.orbit({ center, radius, speed: 3 }));
  await flight.pass(20);
  expect(vehicle.state.mode).toBe('CIRCLE');
  const { distances, turned } = await watch(flight, center, 10);
  expect(Math.min(...distances)).toBeGreaterThan(10);
  expect(Math.max(...distances)).toBeLessThan(20);
  expect(Math.sign(turned)).toBe(Math.sign(radius));
  const { value } = await flight.until(vehicle.getParameter('CIRCLE_RATE'));
  expect(value).toBeCloseTo((Math.sign(radius) * (3 / 15) * 180) / Math.PI, 3);
});

it('circles a place with a plane, which is sent there', async () => {
  const flight = await startFlight([PLANE!]);
  const { vehicle } = flight;
  await flight.pass(2);
  const { latitude, longitude } = vehicle.state.position!;
  const center = { latitude: latitude + 0.001, longitude };
  await flight.until(vehicle.orbit({ center, radius: -90 }));
  await flight.pass(60);
  expect(vehicle.state.mode).toBe('GUIDED');
  const { distances, turned } = await watch(flight, center, 20);
  expect(Math.min(...distances)).toBeGreaterThan(60);
  expect(Math.max(...distances)).toBeLessThan(120);
  expect(turned).toBeLessThan(-90);
});

it('leaves the way to the centre when the pilot wants something else', async () => {
  const flight = await inFlight();
  const { vehicle } = flight;
  const { latitude, longitude } = vehicle.state.position!;
  const orbit = vehicle.orbit({ center: { latitude: latitude + 0.005, longitude } });
  const ended = expect(orbit).rejects.toThrow('a later command replaced this one');
  await flight.pass(3);
  await flight.until(vehicle.hold());
  await ended;
  await flight.pass(5);
  expect(vehicle.state.mode).toBe('BRAKE');
});

it('refuses a circle in which a copter would sink by its throttle stick', async () => {
  const flight = await inFlight();
  const { vehicle } = flight;
  const channels = Object.fromEntries(Array.from({ length: 18 }, (_, index) => [`chan${index + 1}_raw`, 1500]));
  const { latitude, longitude } = vehicle.state.position!;
  for (const pulse of [1000, 1399, 1601]) {
    const packet = new Encoder(1, 1).build('RC_CHANNELS', { chancount: 18, rssi: 254, ...channels, chan3_raw: pulse });
    vehicle.take(new Decoder().push(packet, Date.now())[0]!);
    vehicle.publish(Date.now());
    await expect(vehicle.orbit({ center: { latitude, longitude } })).rejects.toThrow(
      `its throttle stick is at ${pulse} us`,
    );
  }
  expect(vehicle.state.mode).toBe('GUIDED');
});

it('has no circles for vehicles on the ground', async () => {
  const { vehicle } = await startFlight([ROVER!]);
  expect(vehicle.capabilities.orbit).toBe(false);
  await expect(vehicle.orbit({ center: { latitude: 47, longitude: 8 } })).rejects.toThrow(
    'the vehicle has no command for it',
  );
});
