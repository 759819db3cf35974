import { describe, expect, it } from 'vitest';
import { Ring } from './Ring';

describe('Ring', () => {
  it('keeps the newest values', () => {
    const ring = new Ring(3);
    for (let index = 0; index < 5; index++) ring.push(index * 10, index);
    expect(ring.length).toBe(3);
    expect([0, 1, 2].map((index) => ring.valueAt(index))).toEqual([2, 3, 4]);
    expect(ring.lastTime).toBe(40);
    expect(ring.lastValue).toBe(4);
    expect(ring.pushed).toBe(5);
  });

  it('finds values by time', () => {
    const ring = new Ring(4);
    for (const time of [10, 20, 30, 40, 50]) ring.push(time, time);
    expect(ring.indexAt(0)).toBe(0);
    expect(ring.indexAt(30)).toBe(1);
    expect(ring.indexAt(31)).toBe(2);
    expect(ring.indexAt(99)).toBe(4);
  });

  it('never runs backwards', () => {
    const ring = new Ring(4);
    ring.push(100, 1);
    ring.push(90, 2);
    expect(ring.timeAt(1)).toBe(100);
  });

  it('copies for a pause, and clears', () => {
    const ring = new Ring(2);
    ring.push(1, 1);
    const copied = ring.copy();
    ring.push(2, 2);
    expect(copied.length).toBe(1);
    ring.clear();
    expect(ring.lastValue).toBeNull();
    expect(ring.lastTime).toBeNull();
  });

  it('refuses a capacity that is none', () => {
    expect(() => new Ring(0)).toThrow(RangeError);
  });
});
