import { expect, it } from 'vitest';
import { Ring } from './Ring';
import { columnsOf } from './columns';

function ringOf(...points: [number, number][]): Ring {
  const ring = new Ring(10_000);
  for (const [time, value] of points) ring.push(time, value);
  return ring;
}

it('joins series of different rates on one column of times', () => {
  const columns = columnsOf([ringOf([1000, 1], [2000, 2]), ringOf([1500, 5])], 0, 3000, 100);
  expect(columns).toEqual([
    [1, 1.5, 2],
    [1, null, 2],
    [null, 5, null],
  ]);
});

it('returns the window and one value before it', () => {
  const ring = ringOf([1000, 1], [2000, 2], [3000, 3], [4000, 4]);
  expect(columnsOf([ring], 2500, 3500, 100)[0]).toEqual([2, 3, 4]);
});

it('keeps peaks when it reduces', () => {
  const ring = new Ring(10_000);
  for (let index = 0; index < 10_000; index++) ring.push(index, index === 4321 ? 99 : Math.sin(index));
  const [times, values] = columnsOf([ring], 0, 10_000, 300);
  expect(times.length).toBeLessThanOrEqual(600);
  expect(values).toContain(99);
});

it('draws a gap where a value is not finite', () => {
  expect(columnsOf([ringOf([1000, NaN], [2000, 2])], 0, 3000, 10)[1]).toEqual([null, 2]);
});
