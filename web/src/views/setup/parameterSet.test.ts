import { afterEach, describe, expect, it, vi } from 'vitest';

import { Decoder, Encoder, type DecodedMessage, type SentFields } from '$lib/decoder/Decoder';
import type { Parameter, Vehicle } from '$lib/vehicle/Vehicle';

import { EMPTY_METADATA, toggleBit } from './logic/parameters';
import { parameterSet } from './parameterSet.svelte';
import { settled, vehicle } from './testing';

const parameter = (name: string, value: number): Parameter => ({ name, value, text: String(value), type: 'REAL32' });

/** Returns a PARAM_VALUE as it is received. */
function announced(component: number, fields: SentFields): DecodedMessage {
  return new Decoder().push(new Encoder(1, component).build('PARAM_VALUE', fields), 0)[0]!;
}

/** Returns a vehicle that has parameters, and sets them as it is told. */
function parametrised(system: number, values: readonly Parameter[], more: object = {}): Vehicle {
  const setParameter = vi.fn((name: string, value: number) => Promise.resolve(parameter(name, value)));
  return vehicle({
    system,
    capabilities: { params: true },
    getParameters: () => Promise.resolve(values),
    setParameter,
    ...more,
  });
}

async function shown(target: Vehicle): Promise<void> {
  parameterSet.use(target);
  await vi.waitFor(() => expect(parameterSet.isEmpty).toBe(false));
}

afterEach(() => {
  parameterSet.use(vehicle({ capabilities: { params: false } }));
  parameterSet.refused = null;
});

describe('the parameters', () => {
  it('of the vehicle before are not shown for one that has none', async () => {
    await shown(parametrised(1, [parameter('RTL_ALT', 1)]));
    const getParameters = vi.fn();
    parameterSet.use(vehicle({ capabilities: { params: false }, getParameters }));
    expect([parameterSet.isEmpty, parameterSet.isLoading, getParameters.mock.calls]).toEqual([true, false, []]);
  });

  it('of an earlier download are not shown', async () => {
    const [slow, fast] = [settled<Parameter[]>(), settled<Parameter[]>()];
    const getParameters = vi.fn().mockReturnValueOnce(slow.promise).mockReturnValueOnce(fast.promise);
    const first = parametrised(1, [], { getParameters });
    parameterSet.use(first);
    parameterSet.use(vehicle({ system: 2, capabilities: { params: false } }));
    parameterSet.use(first);
    fast.resolve([parameter('RTL_ALT', 2)]);
    await vi.waitFor(() => expect(parameterSet.isEmpty).toBe(false));
    slow.resolve([parameter('RTL_ALT', 1)]);
    await slow.promise;
    await vi.waitFor(() => expect(parameterSet.isLoading).toBe(false));
    expect(parameterSet.parameters.RTL_ALT?.value).toBe(2);
  });

  it('that one vehicle answers are not shown for another', async () => {
    const answer = settled<Parameter>();
    const setParameter = vi.fn(() => answer.promise);
    await shown(parametrised(1, [parameter('RTL_ALT', 1)], { setParameter }));
    const writing = parameterSet.set('RTL_ALT', 5);
    await vi.waitFor(() => expect(setParameter).toHaveBeenCalled());
    await shown(parametrised(2, [parameter('RTL_ALT', 9)]));
    answer.resolve(parameter('RTL_ALT', 5));
    await writing;
    expect([parameterSet.parameters.RTL_ALT?.value, parameterSet.before]).toEqual([9, {}]);
  });

  it('show what a calibration has changed, but not what is being written', async () => {
    const answer = settled<Parameter>();
    let announce: (component: number, name: string, value: number) => void = () => undefined;
    const onMessage = (_: string, listener: (message: DecodedMessage) => void): (() => void) => {
      announce = (component, name, value) =>
        listener(announced(component, { param_id: name, param_value: value, param_type: 9 }));
      return () => (announce = () => undefined);
    };
    const values = [parameter('CAL_GYRO0_XOFF', 1), parameter('RTL_ALT', 1)];
    const state = { firmware: 'px4', alive: true, component: 1 };
    await shown(parametrised(1, values, { onMessage, state, setParameter: () => answer.promise }));
    const value = (name: string): number | undefined => parameterSet.parameters[name]?.value;
    announce(1, 'CAL_GYRO0_XOFF', 2);
    announce(100, 'CAL_GYRO0_XOFF', 3);
    announce(1, 'NO_SUCH', 3);
    expect([value('CAL_GYRO0_XOFF'), value('NO_SUCH'), parameterSet.before]).toEqual([2, undefined, {}]);

    const writing = parameterSet.set('RTL_ALT', 5);
    // biome-ignore lint/complexity/useLiteralKeys: the brackets reach a private member
    await vi.waitFor(() => expect(parameterSet['writing'].size).toBe(1));
    announce(1, 'RTL_ALT', 5);
    answer.resolve(parameter('RTL_ALT', 5));
    await writing;
    expect([value('RTL_ALT'), parameterSet.before]).toEqual([5, { RTL_ALT: 1 }]);
    announce(1, 'RTL_ALT', 6);
    expect([value('RTL_ALT'), parameterSet.before]).toEqual([6, { RTL_ALT: 1 }]);
    // Another ground station sets it back: there is nothing to undo any more.
    announce(1, 'RTL_ALT', 1);
    expect([value('RTL_ALT'), parameterSet.before]).toEqual([1, {}]);
    announce(1, 'RTL_ALT', 6);

    await shown(parametrised(2, values));
    announce(1, 'RTL_ALT', 7);
    expect(value('RTL_ALT')).toBe(1);
  });

  it('of PX4 are whole numbers, also below 0', async () => {
    let announce: (value: Uint8Array) => void = () => undefined;
    const onMessage = (_: string, listener: (message: DecodedMessage) => void): (() => void) => {
      announce = (value) => listener(announced(1, { param_id: 'COM_FLTMODE1', param_value: value, param_type: 6 }));
      return () => undefined;
    };
    const values = [{ ...parameter('COM_FLTMODE1', 1), type: 'INT32' }];
    await shown(parametrised(1, values, { onMessage, state: { firmware: 'px4', alive: true, component: 1 } }));
    announce(Uint8Array.of(255, 255, 255, 255));
    expect(parameterSet.parameters.COM_FLTMODE1?.value).toBe(-1);
  });

  it('whose encoding is not known keep their value, unless they are floats', async () => {
    let announce: (type: number, name: string) => void = () => undefined;
    const onMessage = (_: string, listener: (message: DecodedMessage) => void): (() => void) => {
      announce = (type, name) => listener(announced(1, { param_id: name, param_value: 4, param_type: type }));
      return () => undefined;
    };
    const values = [{ ...parameter('MODE', 1), type: 'INT32' }, parameter('GAIN', 1)];
    await shown(parametrised(1, values, { onMessage, state: { firmware: 'other', alive: true, component: 1 } }));
    announce(6, 'MODE');
    announce(9, 'GAIN');
    expect(['MODE', 'GAIN'].map((name) => parameterSet.parameters[name]?.value)).toEqual([1, 4]);
  });

  it('of one vehicle are not written to another that was selected meanwhile', async () => {
    const answer = settled<Parameter>();
    const setParameter = vi.fn(() => answer.promise);
    await shown(parametrised(1, [parameter('RTL_ALT', 1)], { setParameter }));
    void parameterSet.set('RTL_ALT', 5);
    const second = parameterSet.set('RTL_ALT', 6);
    await vi.waitFor(() => expect(setParameter).toHaveBeenCalled());
    const other = parametrised(2, [parameter('RTL_ALT', 9)]);
    await shown(other);
    answer.resolve(parameter('RTL_ALT', 5));
    expect(await second).toBe(false);
    expect(vi.mocked(other.setParameter)).not.toHaveBeenCalled();
  });

  it('keep both of two bits that are changed at once', async () => {
    await shown(parametrised(1, [parameter('SERVO_MASK', 0)]));
    await Promise.all([0, 3].map((bit) => parameterSet.set('SERVO_MASK', (held) => toggleBit(held, bit))));
    expect([parameterSet.parameters.SERVO_MASK?.value, parameterSet.before]).toEqual([9, { SERVO_MASK: 0 }]);
    await parameterSet.set('SERVO_MASK', 0);
    expect(parameterSet.before).toEqual({});
  });

  it('need the reboot of their own vehicle', async () => {
    const first = parametrised(1, [parameter('FRAME_CLASS', 1)]);
    await shown(first);
    parameterSet.metadata = { FRAME_CLASS: { ...EMPTY_METADATA, name: 'FRAME_CLASS', reboot_required: true } };
    await parameterSet.set('FRAME_CLASS', 2);
    expect(parameterSet.needsReboot).toBe(true);
    await shown(parametrised(2, [parameter('FRAME_CLASS', 1)]));
    expect(parameterSet.needsReboot).toBe(false);
    await shown(first);
    expect(parameterSet.needsReboot).toBe(true);
    parameterSet.rebooted(first);
    expect(parameterSet.needsReboot).toBe(false);
  });

  it('of a file that are refused are told with the reasons', async () => {
    const refuse = (name: string): Promise<Parameter> => Promise.reject(new Error(`${name} is read-only`));
    const first = parametrised(1, [parameter('STAT_RUNTIME', 1)], { setParameter: refuse });
    await shown(first);
    await parameterSet.setAll(new Map([['STAT_RUNTIME', 2]]));
    expect(parameterSet.refused).toEqual({ vehicle: first, lines: ['STAT_RUNTIME: STAT_RUNTIME is read-only'] });
    expect(parameterSet.isWriting).toBe(false);
  });
});
