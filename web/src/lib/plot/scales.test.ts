import { expect, it } from 'vitest';

import { scalesOf } from './scales';

it('gives lines of one unit one scale', () => {
  const { ofLines, all } = scalesOf([{ unit: 'rad' }, { unit: 'm' }, { unit: 'rad' }, {}, {}]);
  expect(ofLines).toEqual(['y0', 'y1', 'y0', 'y2', 'y2']);
  expect(all.map(({ unit }) => unit)).toEqual(['rad', 'm', '']);
});

it('has axes at the left and at the right, and no more', () => {
  expect(scalesOf([{ unit: 'a' }, { unit: 'b' }, { unit: 'c' }]).all.map(({ hasAxis }) => hasAxis)).toEqual([
    true,
    true,
    false,
  ]);
});
