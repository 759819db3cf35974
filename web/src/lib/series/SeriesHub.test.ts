import { describe, expect, it } from 'vitest';
import { SeriesHub, type Series } from './SeriesHub';
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

describe('the age of a value', () => {
  const ref = { source: 'a', message: 'ROW', field: 'x' };
  const fed = (times: readonly number[], value: unknown = 1): Series => {
    const hub = new SeriesHub();
    const series = hub.watch(ref);
    for (const time of times) hub.feed({ source: 'a', message: 'ROW', time, fields: { x: value } });
    return series;
  };

  it('is told when the next value is overdue by the rate of the field', () => {
    const fast = fed([0, 100, 200, 300]);
    expect(fast.overdue(3000)).toBeNull();
    expect(fast.overdue(4300)).toBe(4000);
    expect(fast.value).toBe(1);
    const slow = fed([0, 20_000, 40_000]);
    expect(slow.overdue(100_000)).toBeNull();
    expect(slow.overdue(140_000)).toBe(100_000);
    const once = fed([0]);
    expect(once.overdue(9000)).toBeNull();
    expect(once.overdue(11_000)).toBe(11_000);
    expect(fed([]).overdue(1e9)).toBeNull();
  });

  it('grows while only NaN comes, and the value before is kept', () => {
    const hub = new SeriesHub();
    const series = hub.watch(ref);
    for (const [time, x] of [
      [0, 5],
      [100, 6],
      [200, NaN],
      [9000, NaN],
    ] as const) {
      hub.feed({ source: 'a', message: 'ROW', time, fields: { x } });
    }
    expect(series.value).toBe(6);
    expect(series.overdue(9000)).toBe(8900);
    hub.clear();
    expect(series.overdue(9000)).toBeNull();
  });

  it('of a field that objects have anyway is none', () => {
    const hub = new SeriesHub();
    const series = hub.watch({ source: 'a', message: 'ROW', field: 'constructor' });
    hub.feed({ source: 'a', message: 'ROW', time: 1, fields: {} });
    expect(series.latest).toBeNull();
  });
});
