import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { Decoder, Encoder } from '$lib/decoder/Decoder';

import { ReplayTransport, recordsOf } from './ReplayTransport';

const START = 1_790_000_000_000;

/** A recording with one packet each second, and bytes of a crash in it. */
function recording(seconds: number): Uint8Array {
  const encoder = new Encoder(1, 1);
  const bytes: number[] = [];
  for (let second = 0; second < seconds; second += 1) {
    const time = new DataView(new ArrayBuffer(8));
    time.setBigUint64(0, BigInt(START + second * 1000) * 1000n);
    bytes.push(...new Uint8Array(time.buffer), ...encoder.build('SYSTEM_TIME', { time_boot_ms: second + 1 }));
    if (second === 2) bytes.push(1, 2, 3);
  }
  return Uint8Array.from(bytes);
}

beforeEach(() => vi.useFakeTimers({ now: 0 }));
afterEach(() => vi.useRealTimers());

function started(seconds: number): { replay: ReplayTransport; seen: number[] } {
  const replay = new ReplayTransport(recording(seconds));
  const decoder = new Decoder();
  const seen: number[] = [];
  replay.onData((data, time) => {
    for (const message of decoder.push(data, time)) seen.push((message.time - START) / 1000);
  });
  return { replay, seen };
}

describe('ReplayTransport', () => {
  it('plays packets at their times, faster when asked', async () => {
    const { replay, seen } = started(20);
    await replay.open();
    vi.advanceTimersByTime(2100);
    expect(seen).toEqual([0, 1, 2]);
    replay.speed = 5;
    vi.advanceTimersByTime(1000);
    expect(seen.at(-1)).toBe(7);
    replay.pause();
    vi.advanceTimersByTime(5000);
    expect(seen.at(-1)).toBe(7);
  });

  it('seeks: the minute before gives the state', () => {
    const { replay, seen } = started(200);
    replay.seek(START + 150_000);
    expect([seen[0], seen.at(-1), replay.now() - START]).toEqual([90, 150, 150_000]);
    replay.seek(0);
    expect(replay.now()).toBe(START);
  });

  it('stops at the end', async () => {
    const { replay, seen } = started(3);
    await replay.open();
    vi.advanceTimersByTime(10_000);
    expect([seen.length, replay.paused, replay.now()]).toEqual([3, true, replay.end]);
  });

  it('refuses a file without packets', async () => {
    const replay = new ReplayTransport(new Uint8Array(100));
    await expect(replay.open()).rejects.toThrow('the file has no packets');
    expect(replay.state).toBe('failed');
  });

  it('skips damaged bytes', () => {
    expect(recordsOf(recording(5))).toHaveLength(5);
  });
});
