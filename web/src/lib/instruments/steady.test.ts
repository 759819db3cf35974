import { expect, it } from 'vitest';

import { steady } from './steady';

it('keeps values that look the same, and takes others', () => {
  const keep = steady<{ roll: number | null; unit: string }>();
  const first = keep({ roll: 1.02, unit: 'm' });
  expect(keep({ roll: 1.04, unit: 'm' })).toBe(first);
  expect(keep({ roll: 1.06, unit: 'm' })).toEqual({ roll: 1.06, unit: 'm' });
  expect(keep({ roll: 1.06, unit: 'ft' }).unit).toBe('ft');
  expect(keep({ roll: null, unit: 'ft' }).roll).toBeNull();
});

it('compares with what is shown, so that slow changes add up', () => {
  const keep = steady<{ heading: number }>();
  const shown = [0, 0.04, 0.08, 0.12, 0.16].map((heading) => keep({ heading }).heading);
  expect(shown).toEqual([0, 0, 0.08, 0.08, 0.16]);
});
