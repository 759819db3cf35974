import { expect, it } from 'vitest';

import { offsetOf, placeOf, positiveOrNull } from './slots';

const LEADER = { latitude: 47.4, longitude: 8.5 };

it('places slots forward and right of a leader by its course', () => {
  const ahead = offsetOf(LEADER, placeOf([10, 0, 0], LEADER, 90));
  expect([ahead.north, ahead.east].map((value) => Math.round(value * 10) / 10 + 0)).toEqual([0, 10]);
  const behind = offsetOf(LEADER, placeOf([-5, 5, 0], LEADER, 0));
  expect([behind.north, behind.east].map((value) => Math.round(value * 10) / 10)).toEqual([-5, 5]);
  expect(placeOf([0, 0, 3], LEADER, 45)).toBe(LEADER);
});

it('takes empty and impossible numbers as none', () => {
  expect([8, 0, -2, null, undefined, Number.NaN].map(positiveOrNull)).toEqual([8, null, null, null, null, null]);
});
