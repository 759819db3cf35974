import { expect, it } from 'vitest';
import { SeriesHub } from './SeriesHub';
import { type Sample, parseFieldRef } from './fieldRef';

const sample = (source: string, message: string, fields: Record<string, unknown>, time = 1000): Sample => ({
  source,
  message,
  time,
  fields,
});
const ref = (text: string) => parseFieldRef(text)!;

it('keeps the series that are watched, and latches values', () => {
  const hub = new SeriesHub();
  const roll = hub.watch(ref('1:ATTITUDE.roll'));
  hub.feed(sample('1/1', 'ATTITUDE', { roll: 0.5, pitch: 1 }));
  hub.feed(sample('1/1', 'ATTITUDE', { pitch: 2 }, 2000));
  hub.feed(sample('2/1', 'ATTITUDE', { roll: 9 }, 3000));
  expect(roll.value).toBe(0.5);
  expect(roll.time).toBe(1000);
  expect(roll.ring.length).toBe(1);
});

it('ignores messages that are not watched, and unknown ones', () => {
  const hub = new SeriesHub();
  expect(hub.wants('ATTITUDE')).toBe(false);
  hub.feed(sample('1/1', 'UNKNOWN_54321', {}));
  expect(hub.size).toBe(0);
});

it('shares a series until its last user has left', () => {
  const hub = new SeriesHub();
  const [first, second] = [hub.watch(ref('1:A.b')), hub.watch(ref('1:A.b'))];
  expect(first).toBe(second);
  hub.release(first);
  expect(hub.wants('A')).toBe(true);
  hub.release(second);
  expect(hub.wants('A')).toBe(false);
  expect(hub.size).toBe(0);
});

it('reads elements of arrays and texts', () => {
  const hub = new SeriesHub();
  const cell = hub.watch(ref('1:BATTERY_STATUS.voltages[1]'));
  const text = hub.watch(ref('1:STATUSTEXT.text'));
  hub.feed(sample('1/1', 'BATTERY_STATUS', { voltages: [4100, 4000] }));
  hub.feed(sample('1/1', 'STATUSTEXT', { text: 'hello' }));
  expect(cell.value).toBe(4000);
  expect(text.latest).toBe('hello');
  expect(text.value).toBeNull();
});

it('clears for a jump of a replay', () => {
  const hub = new SeriesHub();
  const series = hub.watch(ref('x:ROW.a'));
  hub.feed(sample('x', 'ROW', { a: 1 }));
  hub.clear();
  expect(series.value).toBeNull();
  expect(series.latest).toBeNull();
});
