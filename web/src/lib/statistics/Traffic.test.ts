import { describe, expect, it } from 'vitest';
import { RateMeter, Traffic } from './Traffic';

const packet = (sequence: number, time = 0, id = 30) => ({
  system: 1,
  component: 1,
  sequence,
  id,
  name: `M${id}`,
  time,
  length: 40,
});

describe('loss', () => {
  function lost(...sequences: number[]): number {
    const traffic = new Traffic();
    for (const sequence of sequences) traffic.add(packet(sequence));
    return traffic.list()[0]!.lost;
  }

  it('counts gaps, also over the end of the numbers', () => {
    expect(lost(1, 2, 3)).toBe(0);
    expect(lost(1, 4)).toBe(2);
    expect(lost(254, 1)).toBe(2);
  });

  it('does not count duplicates, late packets and restarts', () => {
    expect(lost(5, 5, 6)).toBe(0);
    expect(lost(5, 6, 4, 7)).toBe(0);
    expect(lost(200, 0, 201)).toBe(55);
  });

  it('is a share of what was sent', () => {
    const traffic = new Traffic();
    traffic.add(packet(0));
    traffic.add(packet(2));
    // The first seconds are no measure of a link.
    expect(traffic.list()[0]!.loss).toBeNull();
    traffic.add({ ...packet(4), time: packet(0).time + 5000 });
    expect(traffic.list()[0]!.loss).toBeCloseTo(2 / 5);
  });
});

describe('rates', () => {
  it('are those of the last five whole seconds', () => {
    const meter = new RateMeter();
    for (let time = 0; time < 8000; time += 100) meter.add(time, 20);
    expect(meter.rates(8000)).toEqual({ packets: 10, bytes: 200 });
    expect(meter.rates(20_000).packets).toBe(0);
    expect(meter.count).toBe(80);
  });

  it('begin with the first second', () => {
    const meter = new RateMeter();
    for (let time = 0; time < 1000; time += 100) meter.add(time, 20);
    expect(meter.rates(1500).packets).toBe(10);
  });
});

it('does not grow with the messages that noise makes', () => {
  const traffic = new Traffic();
  for (let id = 0; id < 5000; id += 1) traffic.add(packet(id & 255, 1000, id));
  expect(traffic.list()[0]!.messages.size).toBe(500);
});

it('keeps sources and messages apart', () => {
  const traffic = new Traffic();
  traffic.add(packet(0, 1000, 30));
  traffic.add(packet(1, 2000, 33));
  traffic.add({ ...packet(7), system: 2 });
  const [first, second] = traffic.list();
  expect([first!.source, second!.source]).toEqual(['1/1', '2/1']);
  expect([...first!.messages.keys()]).toEqual([30, 33]);
  expect(first!.messages.get(33)!.lastTime).toBe(2000);
});
