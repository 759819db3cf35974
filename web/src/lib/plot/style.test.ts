import { expect, it } from 'vitest';
import { clock, readableNumber, shortNumber, uncutLabels } from './style';

it('writes times of day', () => {
  const noon = new Date(2026, 0, 1, 12, 5, 9).getTime() / 1000;
  expect(clock(noon)).toBe('12:05:09');
  expect(clock(noon + 0.25)).toBe('12:05:09.25');
});

it('leaves out labels that an edge would cut', () => {
  expect(uncutLabels(['12:00:00', '12:00:10', '12:00:20'], [20, 100, 180], 200)).toEqual(['', '12:00:10', '']);
  expect(uncutLabels(['12:00:00', '12:00:20'], [28, 172], 200)).toEqual(['12:00:00', '12:00:20']);
});

it('writes numbers of axes', () => {
  expect([0.1 + 0.2, 0, 1234567, 5e9, 1e-6].map(shortNumber)).toEqual(['0.3', '0', '1234567', '5.0e+9', '1.0e-6']);
});

it('writes values with digits that fit', () => {
  expect([null, NaN, 7, 0.0123456, 123.456, 5e-9].map((value) => readableNumber(value))).toEqual([
    '–',
    '–',
    '7',
    '0.012346',
    '123.46',
    '5.000e-9',
  ]);
  expect(readableNumber(1.26, 1)).toBe('1.3');
});
