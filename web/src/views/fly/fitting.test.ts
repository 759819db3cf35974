import { expect, it } from 'vitest';

import { Fitting } from './fitting';

it('shows the first vehicle, and all that come soon after it', () => {
  const fitting = new Fitting();
  expect([fitting.wants(0, '', true, 0), fitting.wants(20, '', true, 10)]).toEqual([false, true]);
  expect([fitting.wants(20, '', true, 20), fitting.wants(100, '', true, 2000)]).toEqual([false, true]);
  expect(fitting.wants(101, '', true, 9000)).toBe(false);
});

it('shows them beside the panels once these are there, and not whenever a panel changes', () => {
  const fitting = new Fitting();
  expect([fitting.wants(9, '0', true, 0), fitting.wants(9, '320', true, 100)]).toEqual([true, true]);
  expect(fitting.wants(9, '360', true, 9000)).toBe(false);
});

it('leaves the map to a user who moved it', () => {
  const fitting = new Fitting();
  expect([fitting.wants(1, '', true, 0), fitting.wants(2, '320', false, 100)]).toEqual([true, false]);
});

it('shows one more vehicle of a small fleet at any time, and begins again with another link', () => {
  const fitting = new Fitting();
  expect([fitting.wants(1, '', true, 0), fitting.wants(2, '', true, 60_000)]).toEqual([true, true]);
  fitting.reset();
  expect(fitting.wants(3, '', false, 70_000)).toBe(true);
});
