import { afterEach, expect, it } from 'vitest';

import type { DecodedMessage } from '$lib/decoder/Decoder';

import { messages } from './messages.svelte';

afterEach(() => messages.clear());

function message(system: number, component: number, name: string, time: number): DecodedMessage {
  return { system, component, sequence: 0, time, id: 0, name, fields: {}, length: 20, bytes: new Uint8Array() };
}

it('has the latest message of each name, of one component or of the one that sent it last', () => {
  for (const [component, time] of [
    [1, 10],
    [2, 20],
    [1, 5],
  ] as const)
    messages.take(message(1, component, 'ATTITUDE', time));
  expect(messages.latest(1, 'ATTITUDE')?.message.time).toBe(20);
  expect(messages.latest(1, 'ATTITUDE', 1)).toMatchObject({ count: 2, message: { time: 5 } });
  expect(messages.latest(2, 'ATTITUDE')).toBeNull();
  messages.take(message(2, 1, 'ATTITUDE', 1));
  expect([messages.list(1).length, messages.list(3).length, messages.list().length]).toEqual([2, 0, 3]);
});

it('does not grow with the names that noise makes', () => {
  for (let id = 0; id < 5000; id += 1) messages.take(message(1, 1, `UNKNOWN_${id}`, id));
  expect(messages.list(1)).toHaveLength(500);
  expect(messages.latest(1, 'UNKNOWN_4999')).not.toBeNull();
});

it('measures rates, and falls to zero when a message stops', () => {
  messages.publish(0);
  for (let time = 0; time <= 2000; time += 100) messages.take(message(1, 1, 'ATTITUDE', time));
  messages.publish(2000);
  expect(messages.latest(1, 'ATTITUDE')?.rate).toBeCloseTo(10.5);
  messages.publish(4100);
  expect(messages.latest(1, 'ATTITUDE')?.rate).toBe(0);
});
