import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import type { CommandResult } from '$lib/vehicle/Vehicle';

import { MotorTest } from './motorTest.svelte';
import { settled, vehicle } from './testing';

/** Throttles and seconds of the messages that were sent, as ArduPilot takes them. */
function sentBy(sendMessage: ReturnType<typeof vi.fn>): number[][] {
  return sendMessage.mock.calls.map(([, fields]) => [fields.param1, fields.param3, fields.param4]);
}

const tested = (values: object) => vehicle({ state: { firmware: 'ardupilot', alive: true }, ...values });

describe('a motor', () => {
  beforeEach(() => vi.useFakeTimers());
  afterEach(() => vi.useRealTimers());

  it('runs while its button is held, and not much longer if the page is gone', async () => {
    const [sendCommand, sendMessage] = [vi.fn().mockResolvedValue({}), vi.fn()];
    const test = new MotorTest(tested({ sendCommand, sendMessage }));
    await test.start(2, 8);
    expect(sendCommand.mock.calls).toEqual([['DO_MOTOR_TEST', [2, 0, 8, 1, 1]]]);
    await vi.advanceTimersByTimeAsync(800);
    expect([test.running, sentBy(sendMessage)]).toEqual([
      2,
      [
        [2, 8, 1],
        [2, 8, 1],
      ],
    ]);
    test.stop();
    await vi.advanceTimersByTimeAsync(5000);
    expect([test.running, sentBy(sendMessage).slice(2)]).toEqual([null, [[2, 0, 0]]]);
  });

  it('is stopped again after the late answer to a command that may have been repeated', async () => {
    const answer = settled<CommandResult>();
    const sendMessage = vi.fn();
    const test = new MotorTest(tested({ sendCommand: () => answer.promise, sendMessage }));
    const starting = test.start(1, 8);
    test.stop();
    expect(sentBy(sendMessage)).toEqual([[1, 0, 0]]);
    answer.resolve({} as CommandResult);
    await starting;
    await vi.advanceTimersByTimeAsync(5000);
    expect(sentBy(sendMessage)).toEqual([
      [1, 0, 0],
      [1, 0, 0],
    ]);
  });

  it('is not run on when the vehicle is lost', async () => {
    const state = { firmware: 'ardupilot', alive: true };
    const sendMessage = vi.fn();
    const test = new MotorTest(tested({ state, sendCommand: vi.fn().mockResolvedValue({}), sendMessage }));
    await test.start(1, 8);
    state.alive = false;
    await vi.advanceTimersByTimeAsync(5000);
    expect([test.running, sentBy(sendMessage)]).toEqual([null, [[1, 0, 0]]]);
  });

  it('that is refused does not run, and the reason is told', async () => {
    const sendMessage = vi.fn();
    const test = new MotorTest(
      tested({ sendCommand: vi.fn().mockRejectedValue(new Error('Motor Test: vehicle not landed')), sendMessage }),
    );
    await test.start(1, 8);
    test.stop();
    await vi.advanceTimersByTimeAsync(5000);
    expect([test.running, test.problem, sentBy(sendMessage)]).toEqual([null, 'Motor Test: vehicle not landed', []]);
  });
});
