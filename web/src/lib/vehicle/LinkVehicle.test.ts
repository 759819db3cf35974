import { MavProtocolCapability } from '$generated';

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { Decoder, Encoder } from '$lib/decoder/Decoder';
import { FLEET } from '$lib/transport/mock/profiles';

import { capabilitiesFrom } from './capabilities';
import { LinkVehicle } from './LinkVehicle';
import { refusal, startFlight } from './testing';

const [COPTER, , PLANE, ROVER, , SUB, MSP] = FLEET as readonly [(typeof FLEET)[0], ...(typeof FLEET)[0][]];

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

describe('actions', () => {
  it('arm, take off, fly somewhere, land', async () => {
    const flight = await startFlight([COPTER!]);
    const { vehicle } = flight;
    expect(vehicle.state).toMatchObject({
      type: 'copter',
      firmware: 'ardupilot',
      armed: false,
      inAir: false,
      ready: true,
    });
    await flight.until(vehicle.setMode('GUIDED'));
    await flight.until(vehicle.arm());
    await flight.until(vehicle.takeoff(20));
    await flight.pass(15);
    expect(vehicle.state).toMatchObject({ armed: true, inAir: true, mode: 'GUIDED' });
    expect(vehicle.state.position?.relativeAltitude).toBeCloseTo(20, 0);
    const { latitude, longitude } = vehicle.state.position!;
    await flight.until(vehicle.goto({ latitude: latitude + 0.0005, longitude }));
    await flight.pass(25);
    expect(vehicle.state.position?.latitude).toBeCloseTo(latitude + 0.0005, 5);
    await flight.until(vehicle.land());
    await flight.pass(40);
    expect(vehicle.state).toMatchObject({ armed: false, inAir: false });
  });

  it('let a plane take off in TAKEOFF: ArduPlane refuses NAV_TAKEOFF', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'parked' }]);
    await flight.until(flight.vehicle.arm());
    await flight.until(flight.vehicle.takeoff(35));
    expect(flight.vehicle.state.mode).toBe('TAKEOFF');
    expect(flight.transport.vehicles[0]?.parameters.find(({ name }) => name === 'TKOFF_ALT')?.value).toBe(35);
    await flight.pass(30);
    expect(flight.vehicle.state.position?.relativeAltitude).toBeGreaterThan(30);
    const direct = await refusal(flight, flight.vehicle.sendCommand('NAV_TAKEOFF', [0, 0, 0, 0, 0, 0, 35]));
    expect(direct.message).toContain('FAILED');
  });

  it('land a plane by its mission, or else in AUTOLAND', async () => {
    const flight = await startFlight([PLANE!]);
    await flight.until(flight.vehicle.land());
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe('AUTOLAND');
  });

  it('take off and land a quadplane that calls itself a plane as one that hovers', async () => {
    const flight = await startFlight([{ ...PLANE!, activity: 'parked' }]);
    flight.transport.vehicles[0]!.parameters.find(({ name }) => name === 'Q_ENABLE')!.value = 1;
    const { mode } = flight.vehicle.state;
    const takeoff = await refusal(flight, flight.vehicle.takeoff(20));
    expect(takeoff.message).toBe('taking off 3/1 failed: it is not armed; arm it first');
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe(mode);
    await flight.until(flight.vehicle.arm());
    await flight.pass(1);
    await flight.until(flight.vehicle.land());
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe('QLAND');
  });

  it.each([
    ['copter', COPTER!, 'BRAKE'],
    ['rover', ROVER!, 'HOLD'],
    ['sub', SUB!, 'POSHOLD'],
  ])('hold a %s in a mode that needs no throttle stick', async (_, profile, mode) => {
    const flight = await startFlight([profile]);
    flight.transport.vehicles[0]!.autopilot.armed = true;
    await flight.pass(1);
    await flight.until(flight.vehicle.hold());
    await flight.pass(1);
    expect(flight.vehicle.state.mode).toBe(mode);
  });

  it('hold a rover of PX4, which has no mode HOLD', async () => {
    const sent: number[] = [];
    const packet = new Encoder(1, 1).build('HEARTBEAT', { type: 10, autopilot: 12, base_mode: 0x81 });
    const vehicle = new LinkVehicle(new Decoder().push(packet)[0]!, (_, fields) => sent.push(Number(fields.param3)));
    vehicle.hold().catch(() => undefined);
    await vi.advanceTimersByTimeAsync(0);
    expect(sent).toEqual([3]);
    vehicle.dispose();
  });

  it('go to no place at an altitude that is not known', async () => {
    const sent: string[] = [];
    const packet = new Encoder(1, 1).build('HEARTBEAT', { type: 2, autopilot: 3 });
    const vehicle = new LinkVehicle(new Decoder().push(packet, Date.now())[0]!, (name) => sent.push(name));
    const place = { latitude: 47, longitude: 8 };
    await expect(vehicle.goto(place)).rejects.toThrow(
      'going to a position with 1/1 failed: its altitude is not known, enter one',
    );
    await expect(vehicle.orbit({ center: place })).rejects.toThrow('orbiting with 1/1 failed');
    expect(sent).toEqual([]);
    vehicle.dispose();
  });

  it('tells the reasons of the vehicle when it refuses', async () => {
    const flight = await startFlight([SUB!]);
    const error = await refusal(flight, flight.vehicle.arm());
    expect(error.message).toBe('arming 6/1 failed: FAILED (PreArm: Leak detector triggered)');
    expect(error).toMatchObject({ kind: 'CommandDenied', code: 4, statusTexts: ['PreArm: Leak detector triggered'] });
  });

  it('repeats commands that get lost, and gives up', async () => {
    const lossy = await startFlight([COPTER!], { losesSent: (count) => count < 4 });
    await lossy.until(lossy.vehicle.setMode('GUIDED'));
    await lossy.pass(1);
    expect(lossy.vehicle.state.mode).toBe('GUIDED');
    const dead = await startFlight([COPTER!], { losesSent: () => true });
    const error = await refusal(dead, dead.vehicle.setMode('RTL'));
    expect(error.message).toBe('changing to RTL 1/1 failed: no answer to 5 requests');
    expect(error.kind).toBe('CommandTimeout');
  });

  it('waits while a command is in progress', async () => {
    const flight = await startFlight([COPTER!]);
    const result = await flight.until(flight.vehicle.sendCommand('PREFLIGHT_CALIBRATION', [1]));
    expect(result).toMatchObject({ result: 'ACCEPTED', attempts: 1 });
  });

  it('refuses what makes no sense without sending it', async () => {
    const flight = await startFlight([COPTER!]);
    const before = flight.sent.length;
    const takeoff = await refusal(flight, flight.vehicle.takeoff(-5));
    expect(takeoff.message).toBe('takeoff altitude must be positive and finite, got -5');
    const endless = await refusal(flight, flight.vehicle.takeoff(Infinity));
    expect(endless.message).toBe('takeoff altitude must be positive and finite, got Infinity');
    const orbit = await refusal(
      flight,
      flight.vehicle.orbit({ center: { latitude: 47, longitude: 8 }, altitude: 10, radius: 0 }),
    );
    expect(orbit.message).toBe('orbit radius must be finite and not 0 (negative: counter-clockwise), got 0');
    const mode = await refusal(flight, flight.vehicle.setMode('QRTL'));
    expect(mode.message).toBe('changing to QRTL 1/1 failed: the vehicle has no mode QRTL');
    const command = await refusal(flight, flight.vehicle.sendCommand('NAV_TAKEOF'));
    expect(command.message).toBe('no command is named NAV_TAKEOF');
    expect(flight.sent.length).toBe(before);
  });
});

describe('an action that was replaced', () => {
  it('is not sent again: a vehicle that was disarmed stays disarmed', async () => {
    let isLost = false;
    const flight = await startFlight([COPTER!], { losesSent: () => isLost });
    await flight.until(flight.vehicle.setMode('GUIDED'));
    isLost = true;
    const arming = flight.vehicle.arm();
    arming.catch(() => undefined);
    await flight.pass(0.3);
    isLost = false;
    await flight.until(flight.vehicle.disarm());
    await flight.pass(6);
    expect(flight.transport.vehicles[0]?.autopilot.armed).toBe(false);
    expect((await refusal(flight, arming)).message).toBe('a later command replaced this one');
  });

  it('ends with any other action of the pilot', async () => {
    let isLost = true;
    const flight = await startFlight([COPTER!], { losesSent: () => isLost });
    const arming = flight.vehicle.arm();
    arming.catch(() => undefined);
    isLost = false;
    expect((await refusal(flight, flight.vehicle.hold())).kind).toBe('ActionRefused');
    await flight.pass(6);
    expect(flight.transport.vehicles[0]?.autopilot.armed).toBe(false);
    expect((await refusal(flight, arming)).kind).toBe('Cancelled');
  });

  it('does not go on with its next step', async () => {
    const flight = await startFlight([COPTER!]);
    await flight.until(flight.vehicle.setMode('GUIDED'));
    await flight.until(flight.vehicle.arm());
    const takeoff = flight.vehicle.takeoff(20);
    takeoff.catch(() => undefined);
    await flight.until(flight.vehicle.land());
    await flight.pass(5);
    expect(flight.vehicle.state.position?.relativeAltitude).toBeCloseTo(0, 0);
    expect((await refusal(flight, takeoff)).kind).toBe('Cancelled');
  });

  it('may be a motor test that was stopped', async () => {
    let isLost = true;
    const flight = await startFlight([COPTER!], { losesSent: () => isLost });
    const test = flight.vehicle.sendCommand('DO_MOTOR_TEST', [1, 0, 50, 2]);
    test.catch(() => undefined);
    isLost = false;
    const stop = flight.vehicle.sendCommand('DO_MOTOR_TEST', [1, 0, 0, 0]);
    stop.catch(() => undefined);
    await flight.pass(5);
    expect((await refusal(flight, test)).kind).toBe('Cancelled');
  });

  it('ends with the link', async () => {
    const flight = await startFlight([COPTER!], { losesSent: () => true });
    const arming = flight.vehicle.arm();
    arming.catch(() => undefined);
    flight.vehicle.dispose();
    const before = flight.sent.length;
    await flight.pass(6);
    expect(flight.sent.length).toBe(before);
    expect((await refusal(flight, arming)).message).toBe('the link to the vehicle was closed');
  });
});

describe('a vehicle without a position', () => {
  it.each([
    [
      'goto',
      'going to a position with 1/1 failed: its altitude is not known, enter one',
      (vehicle: LinkVehicle) => vehicle.goto({ latitude: 47, longitude: 8 }),
    ],
    [
      'setAltitude',
      'changing the altitude of 1/1 failed: no position yet',
      (vehicle: LinkVehicle) => vehicle.setAltitude(20),
    ],
    ['takeoff of PX4', 'taking off 1/1 failed: no position yet', (vehicle: LinkVehicle) => vehicle.takeoff(20)],
  ])('is not sent to a guessed altitude: %s', async (_, text, act) => {
    const sent: string[] = [];
    const packet = new Encoder(1, 1).build('HEARTBEAT', { type: 2, base_mode: 128, autopilot: 12 });
    const vehicle = new LinkVehicle(new Decoder().push(packet)[0]!, (name) => sent.push(name));
    await expect(act(vehicle)).rejects.toThrow(text);
    expect(sent).toEqual([]);
    vehicle.dispose();
  });
});

describe('telemetry', () => {
  it('is requested from a vehicle that sends heartbeats only, ever more rarely, and again when it stops', async () => {
    const sent: number[] = [];
    const encoder = new Encoder(1, 1);
    const decoder = new Decoder();
    const vehicle = new LinkVehicle(
      decoder.push(encoder.build('HEARTBEAT', { type: 2, autopilot: 3 }))[0]!,
      (_, fields) => fields.command === 511 && sent.push(Number(fields.param1)),
    );
    await vi.advanceTimersByTimeAsync(3000);
    expect(sent).toEqual([30, 33, 74, 24, 65, 1, 147, 245, 42, 241, 162, 193, 168]);
    await vi.advanceTimersByTimeAsync(9000);
    expect(sent.filter((id) => id === 30)).toHaveLength(2);
    sent.length = 0;
    for (let count = 0; count < 300; count += 1) {
      for (const message of decoder.push(encoder.build('ATTITUDE', {}))) vehicle.take(message);
      await vi.advanceTimersByTimeAsync(100);
    }
    expect(sent.filter((id) => id === 30)).toEqual([]);
    await vi.advanceTimersByTimeAsync(6000);
    expect(sent).toContain(30);
    vehicle.dispose();
    sent.length = 0;
    await vi.advanceTimersByTimeAsync(60_000);
    expect(sent).toEqual([]);
  });
});

describe('capabilities', () => {
  it('of MSP follow from flags and parameters: iNav has missions, not each board has a display', () => {
    const inav = capabilitiesFrom('msp', 'copter', MavProtocolCapability.MISSION_INT, { osd: false });
    expect(inav).toMatchObject({ mission: true, osd: false, vtx: null });
    expect(capabilitiesFrom('msp', 'copter', 0n)).toMatchObject({ mission: false, osd: null });
  });

  it('follow from firmware, type and flags', async () => {
    const copter = (await startFlight([COPTER!])).vehicle.capabilities;
    expect(copter).toMatchObject({
      params: true,
      mission: true,
      fence: true,
      takeoff: true,
      vtol: false,
      msp: false,
    });
    expect(copter.calibration).toContain('compass-motor');
    const plane = (await startFlight([PLANE!])).vehicle.capabilities;
    expect(plane.calibration).toContain('airspeed');
    expect(plane.calibration).not.toContain('esc');
  });

  it('of a flight controller behind an MSP bridge are few', async () => {
    const flight = await startFlight([MSP!]);
    await flight.pass(5);
    expect(flight.vehicle.state).toMatchObject({ firmware: 'msp', mode: 'ANGLE', armed: true });
    expect(flight.vehicle.capabilities).toMatchObject({
      msp: true,
      mission: false,
      takeoff: false,
      osd: true,
      vtx: true,
    });
    const error = await refusal(flight, flight.vehicle.arm());
    expect(error.message).toBe('arming 7/1 failed: UNSUPPORTED');
  });
});
