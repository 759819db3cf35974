import { MavArmAuthDeniedReason, MavCmd, MavResult } from '$generated';
import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, type SentFields } from '$lib/decoder/Decoder';

import { ANSWERS, KINDS, type Row } from './reports';
import { Report } from './systems.svelte';

const encoder = new Encoder(1, 1);
const decoder = new Decoder();
const COUNTS = { rate: 12.4, lost: 3 };

function rowsOf(name: string, fields: SentFields): readonly Row[] {
  const message = decoder.push(encoder.build(name, fields))[0]!;
  return KINDS[name]!.read(message.fields, COUNTS);
}

const values = (rows: readonly Row[]): string[] => rows.map(({ name, value }) => `${name}: ${value}`);
const bad = (rows: readonly Row[]): string[] => rows.filter(({ isBad }) => isBad).map(({ name }) => name);

describe('reports of systems', () => {
  it('show the motor controllers of both firmwares by their numbers', () => {
    const ardupilot = rowsOf('ESC_TELEMETRY_5_TO_8', {
      rpm: [5200, 5100, 0, 0],
      voltage: [1580, 1579, 0, 0],
      current: [420, 400, 0, 0],
      temperature: [41, 40, 0, 0],
      count: [7, 7, 0, 0],
    });
    expect(values(ardupilot)).toEqual([
      'Motor 5: 5200 rpm, 15.8 V, 4.2 A, 41 °C',
      'Motor 6: 5100 rpm, 15.8 V, 4.0 A, 40 °C',
    ]);
    const px4 = rowsOf('ESC_STATUS', {
      index: 4,
      rpm: [900, 0, 0, 0],
      voltage: [16.2, Number.NaN, 0, 0],
      current: [1, 0, 0, 0],
    });
    expect(values(px4)[0]).toBe('Motor 5: 900 rpm, 16.2 V, 1.0 A');
    expect(values(px4)[1]).toBe('Motor 6: 0 rpm, 0.0 A');
    const info = rowsOf('ESC_INFO', {
      index: 0,
      count: 3,
      info: 0b101,
      temperature: [4100, 32767, 4000, 0],
      failure_flags: [0, 0, 4, 0],
    });
    expect(values(info)).toEqual(['Motor 1: 41 °C', 'Motor 2: offline', 'Motor 3: 40 °C, OVER_TEMPERATURE']);
    expect(bad(info)).toEqual(['Motor 2', 'Motor 3']);
  });

  it('show generator, engine and modem, and what is wrong with them', () => {
    const generator = rowsOf('GENERATOR_STATUS', {
      status: 4 | 64,
      generator_speed: 7000,
      power_generated: 812.4,
      bus_voltage: 50.4,
      load_current: 16,
      generator_temperature: 80,
    });
    expect(values(generator)).toEqual([
      'State: GENERATING OVERTEMP_WARNING',
      'Speed: 7000 rpm',
      'Power: 812 W, 50.4 V, 16.0 A',
      'Temperature: 80 °C',
    ]);
    expect(bad(generator)).toEqual(['State']);
    const engine = rowsOf('EFI_STATUS', {
      health: 1,
      rpm: 5400,
      engine_load: 71,
      fuel_flow: 22,
      fuel_consumed: 340,
      cylinder_head_temperature: 120,
    });
    expect(values(engine)).toEqual([
      'Speed: 5400 rpm',
      'Load: 71%',
      'Fuel: 22.0 cm³/min, 340 cm³ used',
      'Temperature: 120 °C',
    ]);
    expect(bad(engine)).toEqual([]);
    const modem = rowsOf('CELLULAR_STATUS', { status: 1, failure_reason: 3, type: 4, quality: 255, id: 2 });
    expect(values(modem)).toEqual(['State: FAILED, LTE, SIM_ERROR']);
    expect(bad(modem)).toEqual(['State']);
  });

  it('show the summary of a link of high latency', () => {
    const summary = rowsOf('HIGH_LATENCY2', { failure_flags: 1 | 4096, battery: 63, target_distance: 12 });
    expect(values(summary)).toEqual(['Failures: GPS ESTIMATOR', 'Battery: 63%', 'To the target: 120 m']);
    expect(bad(summary)).toEqual(['Failures']);
    expect(values(rowsOf('HIGH_LATENCY2', { battery: -1 }))[0]).toBe('Failures: none');
  });

  it('show the transponder', () => {
    const status = rowsOf('UAVIONIX_ADSB_OUT_STATUS', { state: 128 | 8, squawk: 21, flight_id: 'LX1     ', fault: 16 });
    expect(values(status)).toEqual([
      'Squawk: 0021',
      'Flight id: LX1',
      'State: transmits, identifies itself, GPS_NO_POS',
    ]);
    expect(bad(status)).toEqual(['State']);
    expect(values(rowsOf('UAVIONIX_ADSB_OUT_STATUS', { squawk: 7000 }))).toEqual(['Squawk: 7000', 'State: standby']);
    expect(bad(rowsOf('UAVIONIX_ADSB_TRANSCEIVER_HEALTH_REPORT', { rfHealth: 2 }))).toEqual(['State']);
  });

  it('count frames and blocks', () => {
    expect(values(rowsOf('CAN_FRAME', { bus: 1 }))).toEqual(['Frames: 12/s']);
    const blocks = rowsOf('LOGGING_DATA', { sequence: 5 });
    expect(values(blocks)).toEqual(['Blocks: 12/s', 'Lost: 3']);
    expect(bad(blocks)).toEqual(['Lost']);
  });

  it('show an aircraft that is a threat', () => {
    const near = { threat_level: 2, action: 2, time_to_minimum_delta: 12.4, horizontal_minimum_delta: 80 };
    const rows = rowsOf('COLLISION', { ...near, altitude_minimum_delta: 30, id: 7 });
    expect(values(rows)).toEqual([
      'Threat: HIGH',
      'Closest, in height: 80 m, 30 m, in 12 s',
      'Evasion: ASCEND_OR_DESCEND',
    ]);
    expect(bad(rows)).toEqual(['Threat']);
    expect(bad(rowsOf('COLLISION', { threat_level: 0, action: 0 }))).toEqual([]);
  });

  it('show answers about failures and arming', () => {
    const answer = (command: number, fields: Record<string, number>): readonly Row[] =>
      ANSWERS[command]!.read(fields, COUNTS);
    const { INJECT_FAILURE, ARM_AUTHORIZATION_REQUEST } = MavCmd;
    expect(values(answer(INJECT_FAILURE, { result: MavResult.ACCEPTED }))).toEqual([
      'Last command: a failure was injected or ended',
    ]);
    expect(values(answer(INJECT_FAILURE, { result: MavResult.DENIED }))).toEqual(['Last command: DENIED']);
    const granted = answer(ARM_AUTHORIZATION_REQUEST, { result: MavResult.ACCEPTED, result_param2: 60 });
    expect(values(granted)).toEqual(['Answer: it may arm for 60 s']);
    const progress = MavArmAuthDeniedReason.INVALID_WAYPOINT;
    const denied = answer(ARM_AUTHORIZATION_REQUEST, { result: MavResult.DENIED, progress, result_param2: 3 });
    expect(values(denied)).toEqual(['Answer: it may not arm: INVALID_WAYPOINT 3']);
  });
});

describe('a stream of reports', () => {
  const block = (sequence: number, time: number) => decoder.push(encoder.build('LOGGING_DATA', { sequence }), time)[0]!;

  it('has a rate, losses, and an age when the next one is overdue', () => {
    const report = new Report(KINDS.LOGGING_DATA!, block(65534, 0), false);
    for (let number = 0; number < 20; number += 1) {
      if (number !== 5 && number !== 6) report.take(block((65534 + number) % 65536, number * 100));
    }
    expect(report.show('log', 2000)).toMatchObject({ rate: 9, lost: 2, overdue: null, instance: null });
    expect(report.show('log', 9000).overdue).toBe(7100);
  });

  it('of an answer is never overdue', () => {
    const report = new Report(ANSWERS[MavCmd.INJECT_FAILURE]!, block(0, 0), true);
    report.take(block(0, 0));
    expect(report.show('ack', 1e6).overdue).toBeNull();
  });
});
