import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, type SentFields } from '$lib/decoder/Decoder';

import { StateTracker } from './StateTracker';

const START = 1_790_000_000_000;

class Station {
  private readonly encoder = new Encoder(1, 1);
  private readonly gimbal = new Encoder(1, 154);
  private readonly decoder = new Decoder();
  readonly tracker: StateTracker;
  time = START;

  constructor(heartbeat: SentFields = { type: 2, autopilot: 3, custom_mode: 4, base_mode: 0x81, system_status: 4 }) {
    this.tracker = new StateTracker(this.decoded(this.encoder, 'HEARTBEAT', heartbeat));
  }

  private decoded(encoder: Encoder, name: string, fields: SentFields) {
    return this.decoder.push(encoder.build(name, fields), this.time)[0]!;
  }

  take(name: string, fields: SentFields, ofGimbal = false) {
    return this.tracker.take(this.decoded(ofGimbal ? this.gimbal : this.encoder, name, fields));
  }

  /** Packets that got lost. */
  lose(count: number): void {
    for (let lost = 0; lost < count; lost += 1) this.encoder.build('PING');
  }

  get state() {
    return this.tracker.snapshot(this.time);
  }
}

describe('StateTracker', () => {
  it('knows which streams ended while others go on', () => {
    const scene = new Station();
    const pass = (seconds: number, ...names: string[]): void => {
      for (let tenth = 0; tenth < seconds * 10; tenth += 1) {
        scene.time += 100;
        for (const name of names) scene.take(name, {});
        if (tenth % 10 === 0) scene.take('HEARTBEAT', { type: 2, autopilot: 3 });
      }
    };
    pass(3, 'ATTITUDE', 'VFR_HUD', 'GLOBAL_POSITION_INT');
    expect(scene.state.overdue).toEqual([]);
    pass(2, 'GLOBAL_POSITION_INT');
    expect(scene.state.overdue).toEqual([]);
    pass(2, 'GLOBAL_POSITION_INT');
    expect(scene.state.overdue).toEqual(['attitude', 'airspeed']);
    pass(4);
    expect(scene.state.overdue).toEqual(['attitude', 'position', 'speed', 'airspeed']);
    pass(1, 'ATTITUDE', 'VFR_HUD');
    expect(scene.state.overdue).toEqual(['position']);
    // Without contact all values are old.
    scene.time += 60_000;
    expect(scene.state).toMatchObject({ alive: false, overdue: [] });
  });

  it('gives a slow stream the time of its own rate', () => {
    const scene = new Station();
    for (let turn = 0; turn < 4; turn += 1) {
      scene.time += 10_000;
      scene.take('BATTERY_STATUS', { voltages: [] });
      scene.take('HEARTBEAT', { type: 2, autopilot: 3 });
    }
    for (let second = 0; second < 41; second += 1) {
      expect(scene.state.overdue).toEqual([]);
      scene.time += 1000;
      scene.take('HEARTBEAT', { type: 2, autopilot: 3 });
    }
    expect(scene.state.overdue).toEqual(['battery']);
  });

  it('reads mode, arming, attitude and position in degrees and metres', () => {
    const scene = new Station();
    scene.take('ATTITUDE', { roll: Math.PI / 6, yaw: -Math.PI / 2 });
    scene.take('GLOBAL_POSITION_INT', {
      lat: 473_977_420,
      lon: 85_455_940,
      alt: 488_000,
      relative_alt: 12_500,
      vx: 300,
      vy: 400,
      vz: -100,
    });
    expect(scene.state).toMatchObject({
      mode: 'GUIDED',
      armed: true,
      type: 'copter',
      firmware: 'ardupilot',
      groundSpeed: 5,
      climbRate: 1,
    });
    expect(scene.state.roll).toBeCloseTo(30, 4);
    expect(scene.state.heading).toBeCloseTo(270, 4);
    expect(scene.state.position).toEqual({
      latitude: 47.397742,
      longitude: 8.545594,
      altitude: 488,
      relativeAltitude: 12.5,
    });
  });

  it('reads the health of the estimate, vibrations, the fence and the charge, of the autopilot only', () => {
    const scene = new Station();
    expect(scene.state).toMatchObject({ estimator: null, vibration: null, fenceBreached: null });
    scene.take('EKF_STATUS_REPORT', {
      flags: 0x33f,
      velocity_variance: 0.1,
      pos_horiz_variance: 0.4,
      compass_variance: 0.2,
    });
    expect(scene.state.estimator).toMatchObject({ worst: 'position', isInitialized: true });
    expect(scene.state.estimator?.ratio).toBeCloseTo(0.5);
    scene.take('EKF_STATUS_REPORT', { flags: 1024 });
    expect(scene.state.estimator?.isInitialized).toBe(false);
    scene.take('ESTIMATOR_STATUS', { vel_ratio: 0.1, mag_ratio: 1.5, tas_ratio: NaN });
    expect(scene.state.estimator).toEqual({ worst: 'compass', ratio: 1.5, isInitialized: true });
    scene.take('VIBRATION', { vibration_x: 3, vibration_y: 31, vibration_z: 20, clipping_0: 1, clipping_2: 2 });
    scene.take('VIBRATION', { vibration_x: 90 }, true);
    expect(scene.state.vibration).toEqual({ level: 31, clipping: 3 });
    scene.take('FENCE_STATUS', { breach_status: 1 });
    scene.take('BATTERY_STATUS', { battery_remaining: 20, charge_state: 2 });
    expect(scene.state).toMatchObject({ fenceBreached: true, battery: { remaining: 0.2, chargeState: 2 } });
  });

  it('keeps values that the sender marks as unknown null', () => {
    const scene = new Station();
    scene.take('SYS_STATUS', { voltage_battery: 65_535, current_battery: -1, battery_remaining: -1 });
    scene.take('GPS_RAW_INT', { fix_type: 1, satellites_visible: 255, eph: 65_535 });
    expect(scene.state.battery).toMatchObject({ voltage: null, current: null, remaining: null });
    expect(scene.state.gps).toMatchObject({ satellites: null, hdop: null });
  });

  it('adds the cells of a battery', () => {
    const scene = new Station();
    scene.take('BATTERY_STATUS', {
      voltages: [4000, 4010, 3990, ...Array<number>(7).fill(65_535)],
      current_battery: 1250,
      battery_remaining: 80,
    });
    expect(scene.state.battery).toMatchObject({ current: 12.5, remaining: 0.8, cells: [4, 4.01, 3.99] });
    expect(scene.state.battery?.voltage).toBeCloseTo(12, 6);
  });

  it('joins the parts of long texts', () => {
    const scene = new Station();
    const part = 'x'.repeat(50);
    expect(scene.take('STATUSTEXT', { severity: 4, text: part, id: 7, chunk_seq: 0 })).toBeNull();
    expect(scene.take('STATUSTEXT', { severity: 4, text: 'end', id: 7, chunk_seq: 1 })?.text).toBe(`${part}end`);
    expect(scene.take('STATUSTEXT', { severity: 6, text: 'short' })?.text).toBe('short');
    expect(scene.state.statusTexts).toHaveLength(2);
  });

  it('is not confused by a gimbal with the same system id', () => {
    const scene = new Station();
    scene.take('ATTITUDE', { roll: 1 }, true);
    scene.take('HEARTBEAT', { type: 26, autopilot: 8 }, true);
    expect(scene.state).toMatchObject({ roll: null, type: 'copter' });
  });

  it('counts losses and rates', () => {
    const scene = new Station();
    const receive = (seconds: number): void => {
      for (let count = 0; count < seconds * 10; count += 1) {
        scene.time += 100;
        scene.lose(1);
        scene.take('ATTITUDE', {});
      }
    };
    receive(4);
    // The first seconds are no measure of a link.
    expect(scene.state.loss).toBeNull();
    receive(3);
    expect(scene.state.loss).toBeCloseTo(0.5, 1);
    expect(scene.state.rate).toBeCloseTo(10, 0);
  });

  it('reads radio channels of RC_CHANNELS_RAW, port by port, where RC_CHANNELS is missing', () => {
    const scene = new Station();
    const port = (number: number, first: number): object =>
      Object.fromEntries(
        Array.from({ length: 8 }, (_, index) => [`chan${index + 1}_raw`, first + index]).concat([['port', number]]),
      );
    scene.take('RC_CHANNELS_RAW', { ...port(1, 1109), chan8_raw: 0xffff, rssi: 1 });
    scene.take('RC_CHANNELS_RAW', { ...port(0, 1101), chan2_raw: 0, rssi: 127 });
    scene.take('RC_CHANNELS_RAW', { ...port(0, 900) }, true);
    scene.take('RC_CHANNELS_RAW', { ...port(200, 900) });
    expect(scene.state.rc).toEqual({
      channels: [1101, null, 1103, 1104, 1105, 1106, 1107, 1108, 1109, 1110, 1111, 1112, 1113, 1114, 1115, null],
      rssi: 0.5,
    });
    scene.take('RC_CHANNELS', { chancount: 2, chan1_raw: 1500, chan2_raw: 0, rssi: 254 });
    scene.take('RC_CHANNELS_RAW', port(0, 1101) as SentFields);
    expect(scene.state.rc).toEqual({ channels: [1500, null], rssi: 1 });
  });

  it('knows when contact is lost', () => {
    const scene = new Station();
    scene.time += 4900;
    expect(scene.state.alive).toBe(true);
    scene.time += 200;
    expect(scene.state.alive).toBe(false);
  });

  it('names a mode as the vehicle does, and not by the mode before', () => {
    const scene = new Station({ type: 2, autopilot: 0, custom_mode: 5 });
    expect(scene.state.mode).toBeNull();
    scene.take('AVAILABLE_MODES', { custom_mode: 5, mode_name: 'ANGLE' });
    scene.take('AVAILABLE_MODES', { custom_mode: 6, mode_name: 'HORIZON' });
    expect(scene.state.mode).toBe('ANGLE');
    scene.take('HEARTBEAT', { type: 2, autopilot: 0, custom_mode: 6 });
    expect(scene.state.mode).toBe('HORIZON');
    scene.take('HEARTBEAT', { type: 2, autopilot: 0, custom_mode: 7 });
    expect(scene.state.mode).toBeNull();
  });

  it('keeps a bounded number of status texts whose end is missing', () => {
    const scene = new Station();
    const piece = 'x'.repeat(50);
    for (let id = 1; id <= 40; id += 1) scene.take('STATUSTEXT', { severity: 6, text: piece, id, chunk_seq: 0 });
    expect(scene.take('STATUSTEXT', { severity: 6, text: 'end', id: 40, chunk_seq: 1 })?.text).toBe(`${piece}end`);
    expect(scene.take('STATUSTEXT', { severity: 6, text: 'end', id: 1, chunk_seq: 1 })?.text).toBe('…end');
  });

  it('measures rates again when a replay goes back', () => {
    const scene = new Station();
    const second = (): void => {
      for (let count = 0; count < 20; count += 1) {
        scene.time += 100;
        scene.take('ATTITUDE', {});
      }
    };
    second();
    scene.time -= 60_000;
    second();
    expect(scene.state.rate).toBeCloseTo(10, 0);
    scene.time += 10_000;
    scene.take('ATTITUDE', {});
    expect(scene.state.rate).toBeLessThan(2);
  });

  it('names the modes of PX4', () => {
    const scene = new Station({ type: 2, autopilot: 12, custom_mode: (4 << 16) | (3 << 24) });
    expect(scene.state).toMatchObject({ firmware: 'px4', mode: 'LOITER' });
    scene.take('SYS_STATUS', { onboard_control_sensors_health: 0x10000000 });
    expect(scene.state.ready).toBe(true);
  });

  it('takes a home that was told before the page listened, until the vehicle tells another', () => {
    const scene = new Station();
    scene.tracker.learnHome(47, 8, 500);
    expect(scene.state.home).toMatchObject({ latitude: 47, longitude: 8, altitude: 500 });
    scene.take('HOME_POSITION', { latitude: 460_000_000, longitude: 70_000_000, altitude: 400_000 });
    scene.tracker.learnHome(47, 8, 500);
    expect(scene.state.home).toMatchObject({ latitude: 46, longitude: 7, altitude: 400 });
  });

  it('shows a vehicle that sends HIGH_LATENCY2 in place of heartbeats', () => {
    const scene = new Station();
    const summary = {
      type: 1,
      autopilot: 12,
      custom_mode: 0x0304,
      latitude: 470_000_000,
      longitude: 80_000_000,
      altitude: 620,
      heading: 90,
      groundspeed: 75,
      battery: 63,
      wp_num: 4,
      custom0: -128,
    };
    scene.take('HIGH_LATENCY2', summary);
    expect(scene.state).toMatchObject({ type: 'copter', alive: true }); // heartbeats say more
    scene.time += 10_000;
    expect(scene.state.alive).toBe(false);
    scene.take('HIGH_LATENCY2', summary);
    expect(scene.state).toMatchObject({
      type: 'plane',
      firmware: 'px4',
      mode: 'LOITER',
      armed: null,
      alive: true,
      position: { latitude: 47, longitude: 8, altitude: 620, relativeAltitude: null },
      heading: 180,
      groundSpeed: 15,
      battery: { remaining: 0.63 },
      mission: { current: 4 },
    });
    scene.time += 140_000; // PX4 sends one each 67 s
    expect(scene.state.alive).toBe(true);
    scene.time += 20_000;
    expect(scene.state.alive).toBe(false);
    scene.take('HIGH_LATENCY2', { ...summary, autopilot: 3, custom_mode: 11, custom0: -127, battery: -1 });
    expect(scene.state).toMatchObject({
      firmware: 'ardupilot',
      mode: 'RTL',
      armed: true,
      battery: { remaining: 0.63 },
    });
  });
});
