import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { FLEET } from '$lib/transport/mock/profiles';

import type { LinkVehicle } from './LinkVehicle';
import { refusal, startFlight } from './testing';
import type { PlanItem } from './Vehicle';

const [COPTER, , PLANE] = FLEET;
const NEAR: PlanItem = {
  seq: 0,
  command: 16,
  name: 'NAV_WAYPOINT',
  frame: 3,
  params: [0, 0, 0, null, 47.35, 8.537, 20],
  autocontinue: true,
};

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

describe('arming, takeoff and missions', () => {
  it('change nothing where a takeoff is refused', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'parked' }]);
    const altitude = (): number | undefined =>
      flight.transport.vehicles[0]!.parameters.find(({ name }) => name === 'TKOFF_ALT')?.value;
    const [mode, before] = [flight.vehicle.state.mode, altitude()];
    await refusal(flight, flight.vehicle.takeoff(77));
    expect([flight.vehicle.state.mode, altitude()]).toEqual([mode, before]);
    // A quadplane that is armed, but whose firmware refuses.
    flight.transport.vehicles[0]!.parameters.find(({ name }) => name === 'Q_ENABLE')!.value = 1;
    await flight.until(flight.vehicle.arm());
    await flight.pass(1);
    vi.spyOn(flight.transport.vehicles[0]!.autopilot, 'takeoff').mockReturnValue('Takeoff: no');
    await refusal(flight, flight.vehicle.takeoff(20));
    await flight.pass(1);
    expect(flight.vehicle.state).toMatchObject({ armed: true, mode });
  });

  it.each<[string, (vehicle: LinkVehicle) => Promise<unknown>]>([
    ['taking off', (vehicle) => vehicle.takeoff(10)],
    ['landing', (vehicle) => vehicle.land()],
    ['returning', (vehicle) => vehicle.rtl()],
    ['holding', (vehicle) => vehicle.hold()],
    ['going to a position with', (vehicle) => vehicle.goto({ latitude: 47, longitude: 8 }, 10)],
    ['orbiting with', (vehicle) => vehicle.orbit({ center: { latitude: 47, longitude: 8 }, altitude: 10 })],
    ['pausing the mission of', (vehicle) => vehicle.pauseMission()],
  ])('send nothing to a disarmed vehicle: %s', async (operation, act) => {
    const flight = await startFlight([COPTER!]);
    flight.sent.length = 0;
    const error = await refusal(flight, act(flight.vehicle));
    expect([error.kind, error.message]).toEqual([
      'ActionRefused',
      `${operation} 1/1 failed: it is not armed; arm it first`,
    ]);
    expect(flight.sent.filter((name) => name.startsWith('COMMAND') || name.startsWith('PARAM'))).toEqual([]);
  });

  it('send nothing that needs a flying vehicle to one on the ground', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'parked' }]);
    await flight.until(flight.vehicle.arm());
    await flight.pass(1);
    const before = flight.sent.length;
    const error = await refusal(flight, flight.vehicle.goto({ latitude: 47, longitude: 8 }, 50));
    expect(error.message).toContain('it is on the ground; take off first');
    expect(flight.sent.length).toBe(before);
  });

  it('give a flying vehicle its mode back that refuses its mission', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'circle' }]);
    await flight.pass(1);
    const { mode } = flight.vehicle.state;
    expect(mode).not.toBe('AUTO');
    Object.assign(flight.transport.vehicles[0]!.autopilot, { mission: [] });
    await refusal(flight, flight.vehicle.startMission());
    await flight.pass(1);
    expect(flight.vehicle.state).toMatchObject({ armed: true, mode });
  });

  it('give a copter its mode and its parameters back that does not enter a circle', async () => {
    const flight = await startFlight([COPTER!]);
    const { vehicle } = flight;
    const mock = flight.transport.vehicles[0]!;
    const values = (): number[] =>
      mock.parameters.filter(({ name }) => name.startsWith('CIRCLE_')).map(({ value }) => value);
    await flight.until(vehicle.arm());
    await flight.until(vehicle.takeoff(20));
    await flight.pass(15);
    await flight.until(vehicle.setMode('LOITER'));
    await flight.pass(1);
    const before = values();
    delete (mock.autopilot.modes as Record<string, number>).CIRCLE;
    const { latitude, longitude } = vehicle.state.position!;
    await refusal(flight, vehicle.orbit({ center: { latitude, longitude }, radius: -33, speed: 4 }));
    await flight.pass(1);
    expect([vehicle.state.mode, values()]).toEqual(['LOITER', before]);
  });

  it('arm again after a return, in a mode in which the firmware arms', async () => {
    const flight = await startFlight([COPTER!]);
    await flight.until(flight.vehicle.setMode('RTL'));
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe('RTL');
    await flight.until(flight.vehicle.arm());
    await flight.pass(1);
    expect(flight.vehicle.state).toMatchObject({ armed: true, mode: 'GUIDED' });
  });

  it('give a vehicle its mode back that does not arm', async () => {
    const flight = await startFlight([{ ...COPTER!, armingProblem: 'no fix' }]);
    await flight.until(flight.vehicle.setMode('RTL'));
    await flight.pass(1);
    expect((await refusal(flight, flight.vehicle.arm())).message).toContain('arming 1/1 failed');
    await flight.pass(1);
    expect(flight.vehicle.state).toMatchObject({ armed: false, mode: 'RTL' });
  });

  it('do not arm in a mode in which the vehicle would start by itself', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'parked' }]);
    await flight.until(flight.vehicle.setMode('TAKEOFF'));
    await flight.pass(1);
    const { message } = await refusal(flight, flight.vehicle.arm());
    expect(message).toBe(
      'arming 3/1 failed: in mode TAKEOFF it would start by itself: change the mode to FLY_BY_WIRE_A first',
    );
    expect(flight.vehicle.state.armed).toBe(false);
  });

  it('arm for a mission, also after a first one', async () => {
    const flight = await startFlight([COPTER!]);
    const { vehicle } = flight;
    await flight.until(vehicle.uploadPlan('mission', { items: [NEAR], home: null }));
    expect((await refusal(flight, vehicle.startMission())).message).toBe(
      'starting the mission of 1/1 failed: it is not armed',
    );
    await flight.until(vehicle.setMode('RTL'));
    await flight.until(vehicle.startMission(true));
    await flight.pass(2);
    expect(vehicle.state).toMatchObject({ armed: true, mode: 'AUTO' });
    await flight.until(vehicle.disarm(true));
    await flight.pass(1);
    await flight.until(vehicle.startMission(true));
    await flight.pass(1);
    expect(vehicle.state).toMatchObject({ armed: true, mode: 'AUTO' });
  });
});
