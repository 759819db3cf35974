/** A vehicle of the demo behind a link in virtual time, for tests. */

import { expect, vi } from 'vitest';

import { StationError } from '$lib/api/errors';
import { Decoder, Encoder } from '$lib/decoder/Decoder';
import type { MockProfile } from '$lib/transport/mock/profiles';
import { MockTransport } from '$lib/transport/MockTransport';

import { LinkVehicle } from './LinkVehicle';

export interface Flight {
  readonly transport: MockTransport;
  readonly vehicle: LinkVehicle;
  /** Names of the messages that the page sent. */
  readonly sent: string[];
  /** Lets time pass, in seconds. */
  pass(seconds: number): Promise<void>;
  /** Resolves with the result of an action, while time passes. */
  until<Result>(action: Promise<Result>): Promise<Result>;
}

export interface LinkOptions {
  /** Tells whether a packet of the page is lost, by its number. */
  readonly losesSent?: (count: number) => boolean;
  /** Tells whether a chunk for the page is lost, by its number. */
  readonly losesReceived?: (count: number) => boolean;
}

/** Returns whether a chunk is lost: a share of them, the same ones in each run. */
export function someLost(share: number): (count: number) => boolean {
  return (count) => ((count * 2654435761) >>> 0) / 2 ** 32 < share;
}

/** Starts vehicles of the demo; the page acts on the first. Fake timers must be in use. */
export async function startFlight(profiles: readonly MockProfile[], options: LinkOptions = {}): Promise<Flight> {
  const transport = new MockTransport(profiles);
  const decoder = new Decoder();
  const encoder = new Encoder();
  const sent: string[] = [];
  let [sentCount, receivedCount] = [0, 0];
  let vehicle: LinkVehicle | null = null;
  const send = (name: string, fields: Parameters<Encoder['build']>[1]): void => {
    sent.push(name);
    const packet = encoder.build(name, fields);
    if (options.losesSent?.(sentCount++) !== true) transport.send(packet);
  };
  transport.onData((data, time) => {
    if (vehicle !== null && options.losesReceived?.(receivedCount++) === true) return;
    for (const message of decoder.push(data, time)) {
      if (message.system !== profiles[0]?.system) continue;
      if (vehicle === null && message.name === 'HEARTBEAT') vehicle = new LinkVehicle(message, send);
      vehicle?.take(message);
    }
    vehicle?.publish(time);
  });
  await transport.open();
  await vi.advanceTimersByTimeAsync(2000);
  const flown = vehicle as LinkVehicle | null;
  if (flown === null) throw new Error('no heartbeat was received');
  const pass = async (seconds: number): Promise<void> => {
    await vi.advanceTimersByTimeAsync(seconds * 1000);
  };
  const until = async <Result>(action: Promise<Result>): Promise<Result> => {
    let ended = false;
    const settled = action.finally(() => (ended = true));
    settled.catch(() => undefined);
    for (let second = 0; !ended && second < 120; second += 0.1) await pass(0.1);
    return settled;
  };
  return { transport, vehicle: flown, sent, pass, until };
}

/** Returns the error in which an action ends. */
export async function refusal(flight: Flight, action: Promise<unknown>): Promise<StationError> {
  const error: unknown = await flight.until(action).catch((reason: unknown) => reason);
  expect(error).toBeInstanceOf(StationError);
  return error as StationError;
}
