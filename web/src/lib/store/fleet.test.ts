import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { Encoder } from '$lib/decoder/Decoder';
import { ReplayTransport } from '$lib/transport/ReplayTransport';
import { BaseTransport } from '$lib/transport/Transport';
import { tlogOf } from '$lib/series/export';
import { LinkVehicle } from '$lib/vehicle/LinkVehicle';

import { fleet, type MakeVehicle } from './fleet.svelte';
import { status } from './status.svelte';

const NOW = 1_790_000_000_000;
const link: MakeVehicle = (heartbeat, send) => new LinkVehicle(heartbeat, send);
const heartbeat = (system: number): Uint8Array => new Encoder(system, 1).build('HEARTBEAT', { type: 2, autopilot: 3 });

class FakeTransport extends BaseTransport {
  readonly name = 'fake';
  readonly sent: Uint8Array[] = [];
  opened: () => void = () => {};

  open(): Promise<void> {
    return new Promise((resolve) => {
      this.opened = () => {
        this.change('open');
        resolve();
      };
    });
  }

  close(): void {
    this.change('closed');
  }

  send(packets: Uint8Array): void {
    this.sent.push(packets);
  }

  receive(data: Uint8Array): void {
    this.emit(data, Date.now());
  }
}

beforeEach(() => void vi.useFakeTimers({ now: NOW }));
afterEach(() => {
  fleet.disconnect();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

it('finds a vehicle that sends HIGH_LATENCY2 in place of heartbeats', () => {
  const transport = new FakeTransport();
  void fleet.connect(transport, 'server', link);
  transport.receive(new Encoder(7, 1).build('HIGH_LATENCY2', { type: 2, autopilot: 12, custom_mode: 0x0304 }));
  expect(fleet.vehicle(7)?.state).toMatchObject({ type: 'copter', mode: 'LOITER', alive: true });
});

it('sends nothing of a vehicle of the link that was left to the next one', () => {
  const [first, second] = [new FakeTransport(), new FakeTransport()];
  void fleet.connect(first, 'server', link);
  first.receive(heartbeat(1));
  const vehicle = fleet.vehicle(1)!;
  vehicle.sendMessage('COMMAND_LONG', { command: 400, param1: 1 });
  expect(first.sent).toHaveLength(1);
  void fleet.connect(second, 'server', link);
  second.receive(heartbeat(1));
  vehicle.sendMessage('COMMAND_LONG', { command: 400, param1: 1 });
  expect(second.sent).toEqual([]);
});

it('shows the state of the present link, whatever becomes of the one before', async () => {
  const [first, second] = [new FakeTransport(), new FakeTransport()];
  const opening = fleet.connect(first, 'server', link);
  const next = fleet.connect(second, 'server', link);
  second.opened();
  await next;
  first.opened();
  await opening;
  expect(status.link).toBe('open');
});

describe('the frames of a fleet', () => {
  const frames: ((time: number) => void)[] = [];
  let asked = 0;
  let published = 0;
  let start = 0;
  let transport: FakeTransport;

  beforeEach(() => {
    vi.useFakeTimers({ toFake: ['setTimeout', 'performance'] });
    // The fleet is that of the tests before, which had clocks of their own.
    vi.advanceTimersByTime((start += 60_000));
    vi.stubGlobal('requestAnimationFrame', (callback: (time: number) => void) => {
      asked += 1;
      frames.push(callback);
    });
    vi.spyOn(fleet, 'publish').mockImplementation(() => void (published += 1));
    transport = new FakeTransport();
    void fleet.connect(transport, 'server', link);
  });
  afterEach(() => {
    // A publication that is still scheduled must not wait for a clock that has ended.
    vi.advanceTimersByTime(1000);
    run();
    vi.restoreAllMocks();
  });

  /** Goes on to the next frame. */
  function run(): void {
    vi.advanceTimersByTime(1000 / 60);
    for (const each of frames.splice(0)) each(performance.now());
  }

  /** Finds vehicles, and shows them for half a second of frames with a message of each frame. */
  function show(systems: number): void {
    for (let system = 1; system <= systems; system += 1) transport.receive(heartbeat(system));
    vi.advanceTimersByTime(1000);
    run();
    asked = published = 0;
    for (let frame = 0; frame < 30; frame += 1) {
      transport.receive(heartbeat(1));
      run();
    }
  }

  it('shows a large fleet less often than each frame, and asks for no other frames', () => {
    for (const [systems, times] of [
      [3, 30],
      [30, 15],
      [90, 5],
    ] as const) {
      show(systems);
      expect(published).toBe(times);
      expect(asked).toBeLessThanOrEqual(2 * times);
    }
  });

  it('shows the next link when the link before is left while it waits for its interval', () => {
    show(90);
    transport.receive(heartbeat(1));
    const next = new FakeTransport();
    void fleet.connect(next, 'server', link);
    next.receive(heartbeat(7));
    published = 0;
    for (let frame = 0; frame < 7; frame += 1) run();
    expect(published).toBeGreaterThan(0);
    published = 0;
    for (let frame = 0; frame < 5; frame += 1) {
      next.receive(heartbeat(7));
      run();
    }
    expect(published).toBe(5);
  });
});

it('takes the time of a recording for the present time', async () => {
  const packets = [0, 1000, 2000].map((time) => ({ time: NOW - 3_600_000 + time, bytes: heartbeat(1) }));
  await fleet.connect(new ReplayTransport(tlogOf(packets)), 'replay', link);
  await vi.advanceTimersByTimeAsync(2500);
  expect(fleet.now()).toBe(NOW - 3_600_000 + 2000);
  expect(fleet.vehicle(1)?.state.alive).toBe(true);
});

describe('the selected vehicle', () => {
  const transport = new FakeTransport();
  const hear = (system: number): void => transport.receive(heartbeat(system));

  beforeEach(() => void fleet.connect(transport, 'replay', link));

  it('selects the first vehicle of a link, in whichever order they are heard', () => {
    hear(3);
    hear(2);
    expect(fleet.selectedSystem).toBe(2);
  });

  it('keeps the selection when a vehicle with a lower number is switched on later', () => {
    hear(3);
    vi.advanceTimersByTime(4000);
    hear(1);
    expect(fleet.vehicles.map(({ system }) => system)).toEqual([1, 3]);
    expect(fleet.selectedSystem).toBe(3);
  });

  it('keeps what the user selected', () => {
    hear(3);
    fleet.select(3);
    hear(1);
    expect(fleet.selectedSystem).toBe(3);
  });
});
