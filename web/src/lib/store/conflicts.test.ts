import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { ApiClient } from '$lib/api/client';

import { ConflictWatch } from './conflicts';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

it('tells vehicles of conflicts that begin and end, while the station answers', async () => {
  const taken: unknown[] = [];
  let [ready, fails, conflict] = [true, false, null as object | null];
  const fetcher = (): Promise<Response> => {
    if (fails) return Promise.reject(new Error('gone'));
    return Promise.resolve(
      new Response(
        JSON.stringify([
          { system: 1, conflict },
          { system: 9, conflict },
        ]),
      ),
    );
  };
  const vehicle = { takeFacts: ({ conflict: each }: { conflict: object | null }) => taken.push(each) };
  const watch = new ConflictWatch(
    (system) => (system === 1 ? vehicle : null),
    () => ready,
    new ApiClient('/api', fetcher as typeof fetch),
  );
  watch.start();
  await vi.advanceTimersByTimeAsync(2000);
  conflict = { text: 'two vehicles' };
  fails = true;
  await vi.advanceTimersByTimeAsync(2000);
  fails = false;
  await vi.advanceTimersByTimeAsync(2000);
  ready = false;
  await vi.advanceTimersByTimeAsync(4000);
  expect(taken).toEqual([null, { text: 'two vehicles' }]);
  ready = true;
  watch.stop();
  await vi.advanceTimersByTimeAsync(4000);
  expect(taken).toHaveLength(2);
});
