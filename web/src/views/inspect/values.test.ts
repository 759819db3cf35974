import { expect, it } from 'vitest';
import { messageInfo } from '$lib/decoder/Decoder';
import { plottable, shownValue } from './values';

const field = (message: string, name: string) => messageInfo(message)!.fields.find((each) => each.name === name)!;

it('names values of enums and flags', () => {
  expect(shownValue(2, field('HEARTBEAT', 'type'))).toEqual({ text: '2', note: 'QUADROTOR' });
  expect(shownValue(0x81, field('HEARTBEAT', 'base_mode')).note).toBe('SAFETY_ARMED · CUSTOM_MODE_ENABLED');
  expect(shownValue(250, field('HEARTBEAT', 'type')).note).toBe('');
});

it('writes numbers, texts, arrays and bytes', () => {
  expect(shownValue(0.25, null).text).toBe('0.25000');
  expect(shownValue(NaN, null).text).toBe('NaN');
  expect(shownValue('PreArm', null).text).toBe('"PreArm"');
  expect(shownValue([1, 2.5], null).text).toBe('[1, 2.5000]');
  expect(shownValue(new Uint8Array([1, 2]), null).text).toBe('[1, 2]');
  expect(shownValue(new Array<number>(100).fill(0), null).text.endsWith(', …]')).toBe(true);
  expect(shownValue(2n ** 60n, null).text).toBe('1152921504606846976');
});

it('plots numbers and elements of arrays', () => {
  expect(plottable(1)).toEqual([undefined]);
  expect(plottable(NaN)).toEqual([undefined]);
  expect(plottable([4, 5])).toEqual([0, 1]);
  expect(plottable('text')).toEqual([]);
});
