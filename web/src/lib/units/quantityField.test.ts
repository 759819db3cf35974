import { afterEach, expect, it } from 'vitest';

import { settings } from '$lib/store/settings.svelte';

import { QuantityField } from './quantityField.svelte';

afterEach(() => (settings.units.value = 'metric'));

it('stays the same amount when the units change, and sends what it shows', () => {
  const altitude = new QuantityField('altitude', 10);
  expect([altitude.shown, altitude.amount]).toEqual([10, 10]);
  settings.units.value = 'imperial';
  expect([altitude.shown, altitude.amount]).toEqual([33, expect.closeTo(10.06, 2)]);
  altitude.shown = 100.5;
  expect([altitude.shown, altitude.amount]).toEqual([100.5, expect.closeTo(30.63, 2)]);
  settings.units.value = 'metric';
  expect([altitude.shown, altitude.amount]).toEqual([30.6, 30.6]);
});

it('is empty until a number is entered', () => {
  const speed = new QuantityField('speed');
  settings.units.value = 'nautical';
  expect([speed.shown, speed.amount]).toEqual([null, null]);
});
