import { describe, expect, it } from 'vitest';

import type { Parameter } from '$lib/vehicle/Vehicle';

import { CalibrationMachine, cancelCommand, inOrder, kindsOf, startCommand, stateOfPose } from './calibration';
import { readCompassMotor, withPoint } from './compassMotor';
import { readMetadata } from './metadataFiles';
import { channelOf, positionOf, slotOf } from './modeSwitch';
import { motorCommand, motorCount, motorMessage } from './motors';
import { osdItems, readItem, writeItem } from './osd';
import { ownerOf } from './owned';
import {
  chosenAtFirst,
  compare,
  FORMATS,
  readParameters,
  valuesToWrite,
  writeParameters,
  type ParameterFormat,
} from './parameterFiles';
import { EMPTY_METADATA, groupsOf, hasBit, hasOnlyNamed, problemOf, rowsOf, search, toggleBit } from './parameters';
import { FAILSAFES, FLIGHT_MODES, namesOf } from './sections';
import { shellMessages, ShellText } from './shell';

const parameter = (name: string, value: number, type = 'REAL32'): Parameter => ({
  name,
  value,
  type,
  text: String(value),
});
const table = (...list: Parameter[]) => Object.fromEntries(list.map((each) => [each.name, each]));
const parameters = table(
  parameter('RTL_ALT', 1500),
  parameter('RTL_SPEED', 0),
  parameter('ANGLE_MAX', 3000, 'INT16'),
  parameter('ATC_RAT_RLL_P', 0.13500000536441803),
);
const metadata = {
  RTL_ALT: {
    ...EMPTY_METADATA,
    name: 'RTL_ALT',
    short_description: 'Altitude of the return',
    unit: 'cm',
    default: 1500,
    minimum: 30,
    maximum: 300_000,
  },
  ANGLE_MAX: {
    ...EMPTY_METADATA,
    name: 'ANGLE_MAX',
    short_description: 'Largest lean',
    default: 4500,
    values: { '0': 'None' },
    minimum: 1000,
  },
};

describe('parameters', () => {
  const rows = rowsOf(parameters, metadata);
  const names = (filter: Partial<Parameters<typeof search>[1]>) =>
    search(rows, { text: '', group: '', onlyChanged: false, ...filter }).map((each) => each.parameter.name);

  it('are found by words in names and descriptions, names first', () => {
    expect(names({ text: 'rtl' })).toEqual(['RTL_ALT', 'RTL_SPEED']);
    expect(names({ text: 'return altitude' })).toEqual(['RTL_ALT']);
    expect(names({ text: 'a' })[0]).toBe('ANGLE_MAX');
    expect(names({ onlyChanged: true })).toEqual(['ANGLE_MAX']);
    expect(names({ group: 'RTL' })).toEqual(['RTL_ALT', 'RTL_SPEED']);
    expect(groupsOf(rows)).toEqual([
      { name: 'ANGLE', count: 1 },
      { name: 'ATC', count: 1 },
      { name: 'RTL', count: 2 },
    ]);
  });

  it('are ranked by the words of names, of what names stand for, and of descriptions', () => {
    const described = (name: string, short: string, long = '') =>
      [name, { ...EMPTY_METADATA, name, short_description: short, long_description: long }] as const;
    const known = Object.fromEntries([
      described('AVD_F_ALT_MIN', 'ADSB minimum altitude', 'Below it the vehicle takes no action; it may return'),
      described('FENCE_RET_ALT', 'Fence Return Altitude'),
      described('RTL_ALT', 'RTL Altitude', 'The altitude above home to which the vehicle climbs before returning'),
      described('RTL_ALT_FINAL', 'RTL Final Altitude'),
      described('RTL_SPEED', 'Speed of the return'),
      described('BATT_LOW_VOLT', 'Low battery voltage'),
    ]);
    const held = rowsOf(table(...Object.keys(known).map((name) => parameter(name, 1))), known);
    const found = (text: string, of = held) =>
      search(of, { text, group: '', onlyChanged: false }).map((each) => each.parameter.name);
    expect(found('return altitude')[0]).toBe('RTL_ALT');
    expect(found('return altitude').at(-1)).toBe('AVD_F_ALT_MIN');
    expect(found('rtl alt')[0]).toBe('RTL_ALT');
    expect(found('RTL_ALT')[0]).toBe('RTL_ALT');
    expect(found('battery voltages')).toEqual(['BATT_LOW_VOLT']);
    expect(found('altitude submarine')).toEqual([]);
    // Without descriptions too.
    expect(found('return altitude', rowsOf(table(parameter('RTL_ALT', 1), parameter('ALT_HOLD', 1)), {}))).toEqual([
      'RTL_ALT',
    ]);
  });

  it('have values that their metadata allows', () => {
    const problem = (name: 'RTL_ALT' | 'ANGLE_MAX', value: number) =>
      problemOf(value, parameters[name]!, metadata[name]);
    expect(problem('RTL_ALT', 2000)).toBeNull();
    expect(problem('RTL_ALT', 1)).toBe('tooLow');
    expect(problem('RTL_ALT', 1e6)).toBe('tooHigh');
    expect(problem('RTL_ALT', NaN)).toBe('notNumber');
    expect(problem('ANGLE_MAX', 1000.5)).toBe('notWhole');
    expect(problem('ANGLE_MAX', 0)).toBeNull();
    expect(problemOf(1, parameters.RTL_ALT!, { ...EMPTY_METADATA, read_only: true })).toBe('readOnly');
    expect(hasOnlyNamed(metadata.ANGLE_MAX)).toBe(false);
    expect(hasOnlyNamed({ ...metadata.ANGLE_MAX, minimum: null })).toBe(true);
  });

  it('have bits', () => {
    expect([hasBit(5, 0), hasBit(5, 1), hasBit(5, 2)]).toEqual([true, false, true]);
    expect([toggleBit(5, 1), toggleBit(5, 2), toggleBit(0, 31)]).toEqual([7, 1, 2147483648]);
  });

  it('are grouped by what they set', () => {
    const found = namesOf(FAILSAFES, parameters);
    expect(found).toEqual([{ title: 'groupReturn', names: ['RTL_ALT', 'RTL_SPEED'] }]);
    const modes = table(parameter('FLTMODE2', 0), parameter('FLTMODE1', 0), parameter('FLTMODE_CH', 5));
    expect(namesOf(FLIGHT_MODES, modes).map((each) => each.names)).toEqual([['FLTMODE1', 'FLTMODE2'], ['FLTMODE_CH']]);
  });
});

describe('parameter files', () => {
  it('keep all values in every format', () => {
    for (const format of Object.keys(FORMATS) as ParameterFormat[]) {
      const text = writeParameters(Object.values(parameters), format, 1, 1);
      const comparison = compare(parameters, readParameters(text));
      expect([format, comparison.different, comparison.same]).toEqual([format, [], 4]);
    }
  });

  it('differ from a vehicle', () => {
    const file = readParameters('# saved\nRTL_ALT,2000\nparam set RTL_SPEED 0\nATC_RAT_RLL_P 0.135000\nNEW_ONE 1\n');
    expect(compare(parameters, file)).toEqual({
      different: [{ name: 'RTL_ALT', vehicle: 1500, file: 2000, owner: null }],
      onlyFile: ['NEW_ONE'],
      same: 2,
    });
  });

  it('of another vehicle do not choose its id, its counters and its calibration', () => {
    const held = table(
      parameter('SYSID_THISMAV', 1),
      parameter('RTL_ALT', 1500),
      parameter('STAT_BOOTCNT', 3),
      parameter('COMPASS_OFS_X', 12),
    );
    const comparison = compare(
      held,
      readParameters('SYSID_THISMAV,7\nRTL_ALT,2000\nSTAT_BOOTCNT,90\nCOMPASS_OFS_X,-40\n'),
    );
    expect(comparison.different.map(({ name, owner }) => [name, owner])).toEqual([
      ['COMPASS_OFS_X', 'CALIBRATION'],
      ['RTL_ALT', null],
      ['STAT_BOOTCNT', 'COUNTER'],
      ['SYSID_THISMAV', 'IDENTITY'],
    ]);
    expect([...chosenAtFirst(comparison)]).toEqual(['RTL_ALT']);
    expect(['MAV_SYSID', 'MAV_SYS_ID', 'sysid_thismav', 'COMPASS_OFS2_Y', 'XCOMPASS_OFS2_Y'].map(ownerOf)).toEqual([
      'IDENTITY',
      'IDENTITY',
      'IDENTITY',
      'CALIBRATION',
      null,
    ]);
  });

  it('with an id that was chosen set it last', () => {
    const comparison = compare(
      table(parameter('MAV_SYSID', 1), parameter('RTL_ALT', 1500)),
      readParameters('MAV_SYSID,7\nRTL_ALT,2000\n'),
    );
    expect([...valuesToWrite(comparison, new Set(['MAV_SYSID', 'RTL_ALT']))]).toEqual([
      ['RTL_ALT', 2000],
      ['MAV_SYSID', 7],
    ]);
    expect([...valuesToWrite(comparison, chosenAtFirst(comparison))]).toEqual([['RTL_ALT', 2000]]);
  });

  it('that are wrong are told with the line', () => {
    expect(() => readParameters('RTL_ALT,15\nRTL_SPEED,fast')).toThrow(
      'line 2: RTL_SPEED,fast is not a name and a number',
    );
    expect(() => readParameters('# nothing')).toThrow('no parameters');
  });

  it('have metadata of PX4 and of ArduPilot', () => {
    const px4 = readMetadata(
      JSON.stringify({
        parameters: [{ name: 'A', shortDesc: 'B', min: 1, bitmask: [{ index: 2, description: 'C' }] }],
      }),
    );
    expect(px4.A).toMatchObject({ short_description: 'B', minimum: 1, bitmask: { '2': 'C' } });
    const ardupilot = readMetadata(
      JSON.stringify({
        RTL_: { 'ArduCopter:RTL_ALT': { DisplayName: 'D', Range: { low: '2', high: '3' }, Values: { '0': 'E' } } },
      }),
    );
    expect(ardupilot.RTL_ALT).toMatchObject({
      short_description: 'D',
      minimum: 2,
      maximum: 3,
      values: { '0': 'E' },
      group: 'RTL',
    });
    expect(() => readMetadata('{}')).toThrow('no metadata');
    expect(() => readMetadata('<')).toThrow('not JSON');
  });
});

describe('calibration', () => {
  const pose = (machine: CalibrationMachine, position: number) =>
    machine.message('COMMAND_LONG', { command: 42429, param1: position });

  it('of the accelerometer asks for six poses of ArduPilot', () => {
    const machine = new CalibrationMachine('ardupilot', 'accelerometer');
    expect(startCommand('ardupilot', 'accelerometer')).toEqual({
      command: 'PREFLIGHT_CALIBRATION',
      params: [0, 0, 0, 0, 1],
    });
    pose(machine, 16_777_215);
    expect(machine.state.state).toBe('running');
    for (let position = 1; position <= 6; position += 1) {
      pose(machine, position);
      expect(machine.state.step.needs_confirmation).toBe(true);
      expect(machine.confirm()).toEqual({ command: 42429, params: [position] });
      pose(machine, position);
      expect(machine.confirm()).toBeNull();
    }
    expect(machine.state.step.pose).toBe('on its back');
    pose(machine, 16_777_215);
    expect(machine.state.state).toBe('done');
  });

  it('of every firmware has the same order, and only what it has is cancelled', () => {
    expect([inOrder(kindsOf('px4')).slice(0, 3), inOrder(kindsOf('ardupilot')).slice(0, 3)]).toEqual([
      ['accelerometer', 'level', 'gyroscope'],
      ['accelerometer', 'level', 'gyroscope'],
    ]);
    expect(inOrder(['new', 'esc'])).toEqual(['esc', 'new']);
    expect(cancelCommand('ardupilot', 'compass')?.command).toBe('DO_CANCEL_MAG_CAL');
    expect([cancelCommand('ardupilot', 'accelerometer'), cancelCommand('msp', 'compass')]).toEqual([null, null]);
    expect(cancelCommand('px4', 'accelerometer')?.command).toBe('PREFLIGHT_CALIBRATION');
  });

  it('shows which poses are done', () => {
    const step = { task: 'place', text: '', progress: null, needs_confirmation: true };
    const order = ['level', 'nose up', 'nose down'];
    const states = (pose: string | null, pending: readonly string[]) =>
      order.map((each) => stateOfPose({ ...step, pose, pending }, each, order));
    expect(states('nose up', [])).toEqual(['done', 'now', 'pending']);
    expect(states(null, ['level'])).toEqual(['pending', 'done', 'done']);
    expect(states('nose down', ['level'])).toEqual(['pending', 'done', 'now']);
    expect(states(null, [])).toEqual(['pending', 'pending', 'pending']);
  });

  it('of the compass follows the slowest compass', () => {
    const machine = new CalibrationMachine('ardupilot', 'compass');
    machine.accepted();
    machine.message('MAG_CAL_PROGRESS', { compass_id: 0, completion_pct: 60 });
    machine.message('MAG_CAL_PROGRESS', { compass_id: 1, completion_pct: 40 });
    expect(machine.state.step).toMatchObject({ task: 'rotate', progress: 40 });
    machine.message('MAG_CAL_REPORT', { compass_id: 0, cal_status: 4 });
    expect(machine.state.state).toBe('running');
    machine.message('MAG_CAL_REPORT', { compass_id: 1, cal_status: 5 });
    expect(machine.state.state).toBe('failed');
  });

  it('of simple sensors ends with the acknowledgement of ArduPilot, and with the text of PX4', () => {
    const simple = new CalibrationMachine('ardupilot', 'gyroscope');
    simple.accepted();
    expect(simple.state.state).toBe('done');
    const px4 = new CalibrationMachine('px4', 'accelerometer');
    px4.accepted();
    px4.text('[cal] calibration started: 2 accel');
    px4.text('[cal] pending: back front left');
    expect(px4.state.step.pending).toEqual(['nose up', 'nose down', 'on its left side']);
    px4.text('[cal] left orientation detected');
    px4.text('[cal] progress <17>');
    expect(px4.state.step).toMatchObject({ pose: 'on its left side', progress: 17 });
    px4.text('[cal] calibration done: accel');
    expect(px4.state.state).toBe('done');
    expect(startCommand('msp', 'airspeed')).toBeNull();
  });
});

describe('equipment', () => {
  it('motors are run by the command of the firmware', () => {
    expect(motorCommand('ardupilot', 2, 8, 1)).toEqual({ command: 'DO_MOTOR_TEST', params: [2, 0, 8, 1, 1] });
    expect(motorCommand('px4', 1, 8, 1).params).toEqual([0.08, 1, 0, 0, 1]);
    expect(motorMessage(motorCommand('px4', 2, 0, 0))).toEqual({
      command: 310,
      param1: 0,
      param2: 0,
      param3: 0,
      param4: 0,
      param5: 2,
    });
    expect([motorCount(2, undefined), motorCount(13, undefined), motorCount(2, 8)]).toEqual([4, 6, 8]);
  });

  it('the switch of the modes has the positions of the firmware', () => {
    const ardupilot = table(parameter('FLTMODE_CH', 5), parameter('FLTMODE1', 0));
    const px4 = table(parameter('RC_MAP_FLTMODE', 6), parameter('COM_FLTMODE1', 0));
    const reversed = { ...px4, ...table(parameter('RC6_REV', -1)) };
    expect([channelOf('ardupilot', ardupilot), channelOf('px4', px4), channelOf('px4', ardupilot)]).toEqual([5, 6, 0]);
    expect([slotOf('ardupilot', 1, ardupilot), slotOf('px4', 1, px4), slotOf('px4', 1, ardupilot)]).toEqual([
      'FLTMODE1',
      'COM_FLTMODE1',
      null,
    ]);
    const pulses = [1000, 1230, 1231, 1490, 1749, 1750, 2000];
    expect(pulses.map((pulse) => positionOf('ardupilot', pulse, ardupilot))).toEqual([1, 1, 2, 3, 5, 6, 6]);
    expect([null, 0, 2300].map((pulse) => positionOf('ardupilot', pulse, ardupilot))).toEqual([null, null, null]);
    const edges = [1100, 1115, 1275, 1290, 1450, 1465, 1625, 1640, 1800, 1815, 2000];
    expect(edges.map((pulse) => positionOf('px4', pulse, px4))).toEqual([1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6]);
    expect(positionOf('px4', 2000, reversed)).toBe(1);
  });

  it('the effect of motors on the compass is kept by the throttle', () => {
    const point = readCompassMotor({ throttle: 125, current: 5, interference: 3 });
    expect(point).toEqual({ throttle: 12.5, current: 5, interference: 3 });
    const later = { ...point, throttle: 12.8, interference: 4 };
    expect(
      withPoint(withPoint(withPoint([], point), { ...point, throttle: 2 }), later).map((each) => [
        each.throttle,
        each.interference,
      ]),
    ).toEqual([
      [2, 3],
      [12.8, 4],
    ]);
  });

  it('items of the display keep their form and profiles', () => {
    const place = ({ column, row, profiles }: { column: number; row: number; profiles: number }) => [
      column,
      row,
      profiles,
    ];
    const far = { ...readItem('BF_OSD_3_POS', 3, 0), column: 99, row: 99, profiles: 1 };
    expect(place(readItem('BF_OSD_3_POS', 3, writeItem(far)))).toEqual([63, 31, 1]);
    expect(place(readItem('BF_OSD_3_POS', 3, writeItem({ ...far, column: -1, row: -1 })))).toEqual([0, 0, 1]);
    const item = readItem('BF_OSD_3_POS', 3, 0b10_101_1_00110_01001);
    expect(item).toMatchObject({ column: 41, row: 6, profiles: 5, form: 2 });
    expect(writeItem(item)).toBe(0b10_101_1_00110_01001);
    expect(
      osdItems(table(parameter('BF_OSD_10_POS', 0), parameter('BF_OSD_2_POS', 0), parameter('BF_OSD_UNITS', 0))).map(
        (each) => each.number,
      ),
    ).toEqual([2, 10]);
  });

  it('the shell takes lines and leaves out escape sequences', () => {
    const sent = shellMessages(`${'x'.repeat(80)}\n`);
    expect(sent.map((each) => each.count)).toEqual([70, 11]);
    const text = new ShellText();
    const bytes = [...new TextEncoder().encode('nsh> \x1b[Kvef\br\r\nok')];
    text.take(7, bytes);
    text.take(bytes.length - 7, bytes.slice(7));
    expect(text.text).toBe('nsh> ver\nok');
  });
});
