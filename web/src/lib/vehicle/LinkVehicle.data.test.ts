import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import type { DecodedMessage } from '$lib/decoder/Decoder';
import { FLEET } from '$lib/transport/mock/profiles';

import { refusal, someLost, startFlight } from './testing';
import type { Plan } from './Vehicle';

const [COPTER, , PLANE, ROVER] = FLEET as readonly [(typeof FLEET)[0], ...(typeof FLEET)[0][]];

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

describe('parameters', () => {
  it('are read, set and listed, also over a link that loses packets', async () => {
    const flight = await startFlight([ROVER!], { losesReceived: someLost(0.3) });
    const progress: number[] = [];
    const all = await flight.until(flight.vehicle.getParameters((done) => progress.push(done)));
    expect(all.map(({ name }) => name)).toEqual([...all.map(({ name }) => name)].sort());
    expect(all.length).toBe(flight.transport.vehicles[0]?.parameters.length);
    expect(progress.at(-1)).toBe(all.length);
    expect(await flight.until(flight.vehicle.getParameter('TURN_RADIUS'))).toEqual({
      name: 'TURN_RADIUS',
      value: Math.fround(0.9),
      text: '0.9',
      type: 'REAL32',
    });
    expect(await flight.until(flight.vehicle.setParameter('CRUISE_SPEED', 2.5))).toMatchObject({ value: 2.5 });
    expect(await flight.until(flight.vehicle.getParameter('CRUISE_SPEED'))).toMatchObject({ text: '2.5' });
  });

  it('are not refused by a late answer to the question for their type', async () => {
    const flight = await startFlight([ROVER!]);
    let old: DecodedMessage | null = null;
    const end = flight.vehicle.onMessage('PARAM_VALUE', (message) => (old = message));
    await flight.until(flight.vehicle.getParameter('CRUISE_SPEED'));
    end();
    const send = flight.vehicle.sendMessage.bind(flight.vehicle);
    vi.spyOn(flight.vehicle, 'sendMessage').mockImplementation((name, fields) => {
      send(name, fields);
      if (name === 'PARAM_SET') flight.vehicle.take(old!);
    });
    expect(await flight.until(flight.vehicle.setParameter('CRUISE_SPEED', 2.25))).toMatchObject({ value: 2.25 });
  });

  it('that the vehicle keeps are refused', async () => {
    const flight = await startFlight([ROVER!]);
    const { parameters } = flight.transport.vehicles[0]!;
    const kept = parameters.find(({ name }) => name === 'CRUISE_SPEED')!;
    Object.defineProperty(kept, 'value', { get: () => 3, set: () => undefined });
    const error = await refusal(flight, flight.vehicle.setParameter('CRUISE_SPEED', 2.5));
    expect(error).toMatchObject({
      kind: 'ParameterDenied',
      message: 'setting CRUISE_SPEED of 4/1 failed: the vehicle keeps 3',
    });
  });

  it('that their type cannot hold are not sent', async () => {
    const flight = await startFlight([ROVER!]);
    const whole = flight.transport.vehicles[0]!.parameters.find(({ type }) => type !== 9)!;
    const before = whole.value;
    for (const value of [1.5, 2 ** 40]) {
      const error = await refusal(flight, flight.vehicle.setParameter(whole.name, value));
      expect(error.kind).toBe('InvalidArgumentError');
      expect(error.message).toMatch(new RegExp(`^${whole.name} is of type U?INT\\d+, which cannot hold ${value}$`));
    }
    expect(whole.value).toBe(before);
  });

  it('that do not exist end in one error', async () => {
    const flight = await startFlight([ROVER!]);
    const error = await refusal(flight, flight.vehicle.getParameter('NO_SUCH'));
    expect(error.message).toBe('reading NO_SUCH of 4/1 failed: no answer to 5 requests');
  });
});

describe('plans', () => {
  const items = [1, 2, 3].map((seq) => ({
    seq: seq - 1,
    command: 16,
    name: 'NAV_WAYPOINT',
    frame: 3,
    params: [0, 0, 0, null, 47 + seq / 8, 8.54, 30],
    autocontinue: true,
  }));
  const jump = { seq: 3, command: 177, name: 'DO_JUMP', frame: 3, params: [0, 2, 0, 0, 0, 0, 0], autocontinue: false };
  // Metres north, east and down.
  const local = {
    seq: 4,
    command: 16,
    name: 'NAV_WAYPOINT',
    frame: 1,
    params: [0, 0, 0, null, 12.5, -3.25, -10],
    autocontinue: true,
  };
  const plan: Plan = { items: [...items, jump, local], home: null };

  it('come back as they were sent, without the home item of ArduPilot', async () => {
    const flight = await startFlight([COPTER!], { losesReceived: someLost(0.2), losesSent: someLost(0.1) });
    await flight.until(flight.vehicle.uploadPlan('mission', plan));
    // Home, and jumps to the item after it.
    expect(flight.transport.vehicles[0]?.autopilot.mission).toHaveLength(6);
    expect(flight.transport.vehicles[0]?.autopilot.mission[4]?.params[0]).toBe(1);
    const back = await flight.until(flight.vehicle.downloadPlan('mission'));
    expect(back.items).toEqual(plan.items);
    expect(back.home).toMatchObject({ latitude: 47.3494, longitude: 8.5363 });
  });

  it('can be cleared, each kind by itself', async () => {
    const flight = await startFlight([COPTER!]);
    await flight.until(flight.vehicle.uploadPlan('rally', { items: items.slice(0, 1), home: null }));
    await flight.until(flight.vehicle.clearPlan('mission'));
    expect((await flight.until(flight.vehicle.downloadPlan('rally'))).items).toHaveLength(1);
    expect((await flight.until(flight.vehicle.downloadPlan('mission'))).items).toEqual([]);
  });

  it('are flown', async () => {
    const flight = await startFlight([COPTER!]);
    const near = { ...items[0]!, params: [0, 0, 0, null, 47.35, 8.537, 20] };
    await flight.until(flight.vehicle.uploadPlan('mission', { items: [near], home: null }));
    await flight.until(flight.vehicle.setMode('GUIDED'));
    await flight.until(flight.vehicle.arm());
    await flight.until(flight.vehicle.startMission());
    await flight.pass(90);
    expect(flight.vehicle.state.statusTexts.map(({ text }) => text)).toContain('Mission complete');
  });

  it('are paused where the vehicle is', async () => {
    const flight = await startFlight([PLANE!]);
    await flight.until(flight.vehicle.startMission());
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe('AUTO');
    await flight.until(flight.vehicle.pauseMission());
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe('LOITER');
  });
});
