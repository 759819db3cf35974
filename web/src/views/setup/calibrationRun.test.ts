import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { status } from '$lib/store/status.svelte';

import { calibration } from './calibrationRun.svelte';
import { parameterSet } from './parameterSet.svelte';
import { settled, vehicle } from './testing';

const STEP = {
  kind: 'accelerometer',
  task: 'place',
  text: 'Place it.',
  pose: 'level',
  pending: [],
  progress: 0,
  needs_confirmation: true,
};

/** The station's events of the task that the page follows. */
class Events extends EventTarget {
  static readonly CLOSED = 2;
  static latest: Events | null = null;
  readonly url: string;
  onerror: (() => void) | null = null;
  readyState = 1;

  constructor(url: string) {
    super();
    this.url = url;
    Events.latest = this;
  }

  close(): void {
    this.readyState = Events.CLOSED;
  }

  emit(state: string, values: object = {}): void {
    const event = new MessageEvent(state === 'running' ? 'progress' : state, {
      data: JSON.stringify({ state, ...values }),
    });
    this.dispatchEvent(event);
  }
}

/** The requests to the station, and its answers by the method and the beginning of the path. */
let requests: string[] = [];
let answers: Record<string, () => unknown> = {};

beforeEach(() => {
  status.source = 'server';
  [requests, Events.latest] = [[], null];
  answers = { 'POST vehicles/1/calibrations/accelerometer?wait=false': () => ({ task: '7' }) };
  vi.stubGlobal('EventSource', Events);
  vi.stubGlobal('fetch', async (url: string, { method }: RequestInit) => {
    const request = `${method} ${url.replace('./api/', '')}`;
    requests.push(request);
    const value = await (answers[request] ?? (() => ({})))();
    return new Response(JSON.stringify(value), { status: 200 });
  });
});

afterEach(() => {
  calibration.reset();
  status.source = null;
  vi.unstubAllGlobals();
});

const confirmations = (): number => requests.filter((each) => each.endsWith('/confirm')).length;

describe('a calibration of the station', () => {
  it('is confirmed once for each pose', async () => {
    await calibration.start(vehicle({}), 'accelerometer');
    Events.latest!.emit('running', { step: STEP });
    expect(calibration.waits).toBe(true);
    await Promise.all([calibration.confirm(), calibration.confirm()]);
    Events.latest!.emit('running', { step: { ...STEP, progress: 1 } });
    expect([confirmations(), calibration.waits]).toEqual([1, false]);
    Events.latest!.emit('running', { step: { ...STEP, pose: 'nose up' } });
    await calibration.confirm();
    expect(confirmations()).toBe(2);
  });

  it('can be confirmed again after a confirmation that failed', async () => {
    answers['POST vehicles/1/calibrations/accelerometer/confirm'] = () => Promise.reject(new Error('offline'));
    await calibration.start(vehicle({}), 'accelerometer');
    Events.latest!.emit('running', { step: STEP });
    await calibration.confirm();
    expect(calibration.waits).toBe(true);
  });

  it('that is cancelled does not look failed, whichever answer is first', async () => {
    const answer = settled<object>();
    answers['DELETE vehicles/1/calibrations/accelerometer'] = () => answer.promise;
    await calibration.start(vehicle({}), 'accelerometer');
    const cancelling = calibration.cancel();
    Events.latest!.emit('failed', { error: { text: 'the accelerometer calibration of vehicle 1 was cancelled' } });
    answer.resolve({ cancelled: false });
    await cancelling;
    expect([calibration.state, calibration.reasons]).toEqual([
      'cancelled',
      ['The vehicle cannot cancel it: it ends by itself, or goes on when it is started again.'],
    ]);
  });

  it('is removed if it was cancelled before the station had answered its start', async () => {
    const answer = settled<object>();
    answers['POST vehicles/1/calibrations/accelerometer?wait=false'] = () => answer.promise;
    const starting = calibration.start(vehicle({}), 'accelerometer');
    await calibration.cancel();
    expect(calibration.state).toBe('cancelled');
    answer.resolve({ task: '7' });
    await starting;
    expect(requests.at(-1)).toBe('DELETE tasks/7');
    expect(Events.latest).toBeNull();
  });

  it('goes on after the page was loaded again', async () => {
    answers['GET tasks'] = () => [
      { task: '3', name: 'POST /api/vehicles/1/calibrations/gyroscope', state: 'done' },
      { task: '4', name: 'POST /api/vehicles/1/calibrations/accelerometer', state: 'running' },
    ];
    await calibration.resume(vehicle({}));
    Events.latest!.emit('running', { step: STEP });
    expect([calibration.kind, calibration.state, calibration.waits]).toEqual(['accelerometer', 'running', true]);
    expect(Events.latest!.url).toBe('./api/tasks/4/progress');
    await calibration.resume(vehicle({ system: 2 }));
    expect(calibration.vehicle?.system).toBe(1);
  });

  it('tells what it has found, and that a reboot is needed', async () => {
    const outcome = { reboot_needed: true, compasses: [{ id: 0, fitness: 5 }], channels: {} };
    answers['GET tasks/7/result'] = () => outcome;
    const calibrated = vehicle({ capabilities: { params: false } });
    parameterSet.use(calibrated);
    await calibration.start(calibrated, 'accelerometer');
    Events.latest!.emit('done');
    await vi.waitFor(() => expect(calibration.state).toBe('done'));
    expect([calibration.outcome, parameterSet.needsReboot]).toEqual([outcome, true]);
    parameterSet.use(vehicle({ capabilities: { params: false } }));
    expect(parameterSet.needsReboot).toBe(false);
  });
});

describe('a calibration of the page', () => {
  it('does not tell that it was cancelled when the vehicle did not take it', async () => {
    status.source = 'demo';
    const sendCommand = vi.fn().mockResolvedValueOnce({}).mockRejectedValueOnce(new Error('no reply'));
    await calibration.start(vehicle({ sendCommand }), 'esc');
    expect(calibration.state).toBe('running');
    await calibration.cancel();
    expect([calibration.state, calibration.reasons]).toEqual([
      'failed',
      ['It could not be cancelled and may go on: no reply'],
    ]);
  });

  it('reads the parameters again at its end', async () => {
    status.source = 'demo';
    const getParameters = vi.fn().mockResolvedValue([{ name: 'CAL_GYRO0_XOFF', value: 1, text: '1', type: 'REAL32' }]);
    let emit: (text: { text: string }) => void = () => undefined;
    const onStatusText = (listener: typeof emit): (() => void) => {
      emit = listener;
      return () => undefined;
    };
    const target = vehicle({
      sendCommand: vi.fn().mockResolvedValue({}),
      onStatusText,
      getParameters,
      capabilities: { params: true },
    });
    parameterSet.use(target);
    await vi.waitFor(() => expect(parameterSet.isEmpty).toBe(false));
    await calibration.start(target, 'gyroscope');
    expect(getParameters).toHaveBeenCalledOnce();
    emit({ text: '[cal] calibration done: gyro' });
    expect(calibration.state).toBe('done');
    expect(getParameters).toHaveBeenCalledTimes(2);
    parameterSet.use(vehicle({ capabilities: { params: false } }));
  });

  it('fails when the vehicle is lost', async () => {
    status.source = 'demo';
    let publish: (state: object) => void = () => undefined;
    const onState = (listener: typeof publish): (() => void) => {
      publish = listener;
      return () => undefined;
    };
    await calibration.start(vehicle({ sendCommand: vi.fn().mockResolvedValue({}), onState }), 'esc');
    publish({ alive: true });
    expect(calibration.state).toBe('running');
    publish({ alive: false });
    expect([calibration.state, calibration.reasons]).toEqual([
      'failed',
      ['The vehicle does not answer: it may go on calibrating.'],
    ]);
  });
});
