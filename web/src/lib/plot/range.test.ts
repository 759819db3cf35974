import { expect, it } from 'vitest';
import { paddedRange } from './range';

it('leaves a margin above and below a signal', () => {
  expect(paddedRange(0, 100)).toEqual([-8, 108]);
  expect(paddedRange(473977418, 473978418)).toEqual([473977338, 473978498]);
});

it('shows a constant value in the middle', () => {
  expect(paddedRange(0, 0)).toEqual([-1, 1]);
  expect(paddedRange(100, 100)).toEqual([95, 105]);
});

it('does not fill the plot with the noise of a constant value', () => {
  const [low, high] = paddedRange(-1e-9, 1e-9);
  expect(high - low).toBeCloseTo(2);
  const [from, to] = paddedRange(9.806649, 9.80665);
  expect(to - from).toBeGreaterThan(0.5);
});

it('has a range without values', () => {
  expect(paddedRange(null, null)).toEqual([0, 1]);
  expect(paddedRange(0, Infinity)).toEqual([0, 1]);
});

it('does not zoom into the noise of a vehicle at rest', () => {
  const [low, high] = paddedRange(-0.033, -0.027, 'm');
  expect([low, high].map((each) => each.toFixed(2))).toEqual(['-0.53', '0.47']);
  expect(paddedRange(0, 100, 'm')).toEqual([-8, 108]);
  expect(paddedRange(0, 0.01)[1]).toBeLessThan(0.02);
});
