import { expect, it } from 'vitest';

import { placeAt, sideBox } from './showTracks';
import type { Slot } from './slots';

const UP: readonly Slot[] = [
  [0, 0, 0],
  [0, 10, 20],
  [4, 10, 0],
];

it('interpolates between places, and rests before the begin and after the end', () => {
  expect(placeAt(UP, 0.25)).toEqual([0, 5, 10]);
  expect(placeAt(UP, 0.75)).toEqual([2, 10, 10]);
  expect([placeAt(UP, -1), placeAt(UP, 2), placeAt(UP, Number.NaN)]).toEqual([UP[0], UP[2], UP[0]]);
  expect(placeAt([[1, 2, 3]], 0.5)).toEqual([1, 2, 3]);
  expect(placeAt([], 0.5)).toEqual([0, 0, 0]);
});

it('finds the box of all places', () => {
  expect(sideBox([{ places: UP }])).toEqual({ left: -5, right: 12, top: 22 });
  expect(sideBox([])).toEqual({ left: -5, right: 5, top: 5 });
});
