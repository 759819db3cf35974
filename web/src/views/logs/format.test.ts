import { expect, it } from 'vitest';
import { dateText, durationText, sizeText } from './format';

it('writes sizes, dates and durations', () => {
  expect([12, 20_480, 5_300_000].map(sizeText)).toEqual(['12 B', '20 kB', '5.3 MB']);
  expect(dateText(0)).toBe('date unknown');
  expect(dateText(1_790_000_000)).toContain('2026');
  expect([-5, 61_000, 3_723_000].map(durationText)).toEqual(['0:00', '1:01', '1:02:03']);
});
