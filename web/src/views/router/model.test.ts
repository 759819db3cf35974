import { expect, it } from 'vitest';
import { NO_RATES, bytesText, dropReasons, ratesBetween, totalDropped, type Endpoint } from './model';

const ENDPOINT: Endpoint = {
  name: 'ground',
  url: 'udpin://:14550',
  state: 'open',
  reason: '',
  links: [],
  received: 100,
  received_bytes: 4000,
  sent: 10,
  sent_bytes: 400,
  lost: 0,
  dropped: { loop: 2, rule: 5, queue: 0 },
};

it('measures rates between two readings', () => {
  const after = { ...ENDPOINT, received: 120, received_bytes: 5000, sent: 10 };
  expect(ratesBetween(ENDPOINT, after, 2)).toEqual({ received: 10, sent: 0, receivedBytes: 500, sentBytes: 0 });
  expect(ratesBetween(undefined, after, 2)).toEqual(NO_RATES);
  expect(ratesBetween(after, ENDPOINT, 2).received).toBe(0);
});

it('sums drops and tells their reasons', () => {
  expect(totalDropped(ENDPOINT)).toBe(7);
  expect(dropReasons(ENDPOINT)).toBe('rule 5, loop 2');
});

it('writes small and large numbers of bytes', () => {
  expect([0, 21.4, 999, 27_940].map(bytesText)).toEqual(['0 B', '21 B', '999 B', '27.9 kB']);
});
