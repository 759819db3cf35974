import { afterEach, describe, expect, it, vi } from 'vitest';

import { ApiClient } from './client';
import type { StationError } from './errors';

interface Call {
  readonly method: string;
  readonly url: string;
  readonly body: unknown;
}

function clientOf(answers: readonly (() => Response)[]): { client: ApiClient; calls: Call[] } {
  const calls: Call[] = [];
  const fetcher = (url: string, init: RequestInit): Promise<Response> => {
    calls.push({ method: init.method ?? '', url, body: init.body });
    const answer = answers[calls.length - 1];
    return answer === undefined ? Promise.reject(new TypeError('failed to fetch')) : Promise.resolve(answer());
  };
  return { client: new ApiClient('/api', fetcher as typeof fetch), calls };
}

const json =
  (value: unknown, status = 200) =>
  (): Response =>
    new Response(JSON.stringify(value), { status });

async function errorOf(action: Promise<unknown>): Promise<StationError> {
  return (await action.catch((reason: unknown) => reason)) as StationError;
}

afterEach(() => vi.unstubAllGlobals());

describe('ApiClient', () => {
  it('sends JSON and query, and returns JSON', async () => {
    const { client, calls } = clientOf([json({ state: 'done' })]);
    expect(await client.post('vehicles/1/takeoff', { altitude: 10 }, { accepted: true, wait: undefined })).toEqual({
      state: 'done',
    });
    expect(calls).toEqual([{ method: 'POST', url: '/api/vehicles/1/takeoff?accepted=true', body: '{"altitude":10}' }]);
  });

  it('throws the reasons of the vehicle', async () => {
    const error = {
      kind: 'CommandDenied',
      text: 'arming 1/1 failed: FAILED (PreArm: x)',
      code: 4,
      status_texts: ['PreArm: x'],
    };
    const { client } = clientOf([json({ error }, 409)]);
    expect(await errorOf(client.post('vehicles/1/arm'))).toMatchObject({
      kind: 'CommandDenied',
      message: error.text,
      statusTexts: ['PreArm: x'],
      code: 4,
    });
  });

  it('tells a station that does not answer, and pages that are not its own', async () => {
    const { client } = clientOf([() => new Response('<html>', { status: 502, statusText: 'Bad Gateway' })]);
    expect((await errorOf(client.get('vehicles'))).message).toBe('the station answered 502 Bad Gateway');
    expect(await errorOf(client.get('vehicles'))).toMatchObject({
      kind: 'Unreachable',
      message: 'the station does not answer',
    });
  });

  it('asks for the password when the session has ended, but not while it is asked', async () => {
    const refusal = json({ error: { kind: 'Unauthorized', text: 'log in first' } }, 401);
    const { client } = clientOf([refusal, refusal]);
    const asked = vi.fn();
    client.onUnauthorized = asked;
    await errorOf(client.get('session'));
    expect(asked).not.toHaveBeenCalled();
    await errorOf(client.get('vehicles'));
    expect(asked).toHaveBeenCalledOnce();
  });

  it('gives up a station that takes a request and does not answer', async () => {
    vi.useFakeTimers();
    const hanging = (_: string, init: RequestInit): Promise<Response> =>
      new Promise((_resolve, reject) =>
        init.signal!.addEventListener('abort', () => reject(init.signal!.reason as Error)),
      );
    const client = new ApiClient('/api', hanging as typeof fetch);
    const failure = errorOf(client.post('vehicles/1/rtl'));
    await vi.advanceTimersByTimeAsync(60_000);
    expect((await failure).message).toBe('the station does not answer');
    vi.useRealTimers();
  });

  it('ends long work when the station stays away, not when it comes back', async () => {
    vi.useFakeTimers();
    let events: FakeEvents | null = null;
    class FakeEvents {
      static readonly CLOSED = 2;
      readyState = 0;
      onopen: () => void = () => {};
      onerror: () => void = () => {};
      readonly close = vi.fn();
      constructor() {
        events = this;
      }
      addEventListener(): void {}
    }
    vi.stubGlobal('EventSource', FakeEvents);
    const { client } = clientOf([json({ task: '3' }, 202)]);
    const failure = errorOf(client.longJson('GET', 'vehicles/1/parameters'));
    await vi.advanceTimersByTimeAsync(0);
    events!.onerror();
    await vi.advanceTimersByTimeAsync(15_000);
    events!.onopen();
    await vi.advanceTimersByTimeAsync(15_000);
    events!.onerror();
    await vi.advanceTimersByTimeAsync(19_000);
    expect(events!.close).not.toHaveBeenCalled();
    await vi.advanceTimersByTimeAsync(1000);
    expect((await failure).message).toBe('the station does not answer');
    vi.useRealTimers();
  });

  it('follows long work to its result', async () => {
    const listeners = new Map<string, (event: { data: string }) => void>();
    class FakeEvents {
      static readonly CLOSED = 2;
      constructor(readonly url: string) {}
      addEventListener(name: string, listener: (event: { data: string }) => void): void {
        listeners.set(name, listener);
        if (name !== 'cancelled') return;
        queueMicrotask(() => {
          listeners.get('progress')?.({ data: '{"done": 3, "total": 9}' });
          listeners.get('done')?.({ data: '{}' });
        });
      }
      close(): void {}
    }
    vi.stubGlobal('EventSource', FakeEvents);
    const { client, calls } = clientOf([json({ task: '3' }, 202), json({ parameters: [] })]);
    const progress: (number | null)[][] = [];
    expect(
      await client.longJson('GET', 'vehicles/1/parameters', (done, total) => progress.push([done, total])),
    ).toEqual({
      parameters: [],
    });
    expect(progress).toEqual([[3, 9]]);
    expect(calls.map(({ url }) => url)).toEqual(['/api/vehicles/1/parameters?wait=false', '/api/tasks/3/result']);
  });

  it('throws the error of failed work, without a request that the console would show as an error', async () => {
    class FakeEvents {
      static readonly CLOSED = 2;
      addEventListener(name: string, listener: (event: { data: string }) => void): void {
        const error = {
          kind: 'MissionDenied',
          text: 'downloading the fence failed: UNSUPPORTED',
          code: 3,
          status_texts: ['No fence'],
        };
        if (name === 'failed') queueMicrotask(() => listener({ data: JSON.stringify({ task: '3', error }) }));
      }
      close(): void {}
    }
    vi.stubGlobal('EventSource', FakeEvents);
    const { client, calls } = clientOf([json({ task: '3' }, 202)]);
    expect(await errorOf(client.longJson('GET', 'vehicles/1/fence'))).toMatchObject({
      kind: 'MissionDenied',
      message: 'downloading the fence failed: UNSUPPORTED',
      statusTexts: ['No fence'],
      code: 3,
    });
    expect(calls).toHaveLength(1);
  });

  it('cancels long work at the station', async () => {
    let cancelled: () => void = () => {};
    class FakeEvents {
      static readonly CLOSED = 2;
      addEventListener(name: string, listener: () => void): void {
        if (name === 'cancelled') cancelled = listener;
      }
      close(): void {}
    }
    vi.stubGlobal('EventSource', FakeEvents);
    const { client, calls } = clientOf([json({ task: '3' }, 202), json({ state: 'cancelled' })]);
    const aborter = new AbortController();
    const failure = client
      .long('GET', 'vehicles/1/logs/1', undefined, undefined, {}, aborter.signal)
      .catch((error: unknown) => error);
    await vi.waitFor(() => expect(calls).toHaveLength(1));
    await vi.waitFor(() => expect(cancelled.name).not.toBe('cancelled'));
    aborter.abort();
    cancelled();
    expect(await failure).toMatchObject({ name: 'AbortError' });
    expect(calls.map(({ method, url }) => `${method} ${url}`)).toEqual([
      'GET /api/vehicles/1/logs/1?wait=false',
      'DELETE /api/tasks/3',
    ]);
  });
});
