import { afterEach, beforeEach, expect, it, vi } from 'vitest';

import { Encoder } from '$lib/decoder/Decoder';
import type { Transport } from '$lib/transport/Transport';
import { LinkVehicle } from '$lib/vehicle/LinkVehicle';

import { fleet } from './fleet.svelte';

let receive: (data: Uint8Array, time: number) => void;

function hear(system: number): void {
  receive(new Encoder(system, 1).build('HEARTBEAT', { type: 2, autopilot: 3 }), Date.now());
}

beforeEach(async () => {
  vi.useFakeTimers();
  const transport = {
    name: 'test', state: 'open', reason: null, open: () => Promise.resolve(), close: () => undefined, send: () => undefined,
    onState: () => () => undefined,
    onData: (listener: typeof receive) => {
      receive = listener;
      return () => undefined;
    },
  } as unknown as Transport;
  await fleet.connect(transport, 'replay', (heartbeat, send) => new LinkVehicle(heartbeat, send));
});

afterEach(() => {
  fleet.disconnect();
  vi.useRealTimers();
});

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
