import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { MavAutopilot, MavCmd, MavModeFlag, MavResult, MavType } from '$generated';

import { Encoder } from '$lib/decoder/Decoder';

import { findAutopilot, startBootloader, type Autopilot } from './autopilot';

/** A port that receives heartbeats, and keeps the bytes that are sent. */
class Line {
  readonly sent: Uint8Array[] = [];
  private listener: ((data: Uint8Array) => void) | null = null;

  send(data: Uint8Array): void {
    this.sent.push(data);
  }

  onData(listener: (data: Uint8Array) => void): () => void {
    this.listener = listener;
    return () => (this.listener = null);
  }

  get hasListener(): boolean {
    return this.listener !== null;
  }

  heartbeat(system: number, component: number, type: number, autopilot: number, base_mode = 0): void {
    const encoder = new Encoder(system, component);
    this.listener?.(encoder.build('HEARTBEAT', { type, autopilot, base_mode }));
  }

  acknowledge(system: number, result: number): void {
    const command = MavCmd.PREFLIGHT_REBOOT_SHUTDOWN;
    this.listener?.(new Encoder(system, 1).build('COMMAND_ACK', { command, result }));
  }
}

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

async function found(search: Promise<Autopilot | null>): Promise<Autopilot | null> {
  await vi.advanceTimersByTimeAsync(4100);
  return search;
}

it('finds the autopilot among the other components of its vehicle', async () => {
  const line = new Line();
  const search = findAutopilot(line);
  line.heartbeat(255, 190, MavType.GCS, MavAutopilot.INVALID);
  line.heartbeat(7, 154, MavType.GIMBAL, MavAutopilot.INVALID);
  line.heartbeat(7, 1, MavType.QUADROTOR, MavAutopilot.PX4, MavModeFlag.SAFETY_ARMED);
  expect(await found(search)).toEqual({ system: 7, component: 1, isArmed: true });
  expect(line.hasListener).toBe(false);
});

it('finds no other vehicle than the one that is wanted', async () => {
  const line = new Line();
  const search = findAutopilot(line, 7);
  line.heartbeat(8, 1, MavType.QUADROTOR, MavAutopilot.PX4);
  expect(await found(search)).toBeNull();
});

it('sends nothing to an autopilot that is armed', async () => {
  const line = new Line();
  const armed = { system: 7, component: 1, isArmed: true };
  await expect(startBootloader(line, armed)).rejects.toThrow('it is armed; disarm it first');
  expect(line.sent).toEqual([]);
});

describe('an autopilot that is asked to start its bootloader', () => {
  const copter: Autopilot = { system: 3, component: 1, isArmed: false };

  it('confirms, or refuses with its reason', async () => {
    const line = new Line();
    const confirmed = startBootloader(line, copter);
    line.acknowledge(2, MavResult.DENIED);
    line.acknowledge(3, MavResult.ACCEPTED);
    await expect(confirmed).resolves.toBe(true);
    const refused = startBootloader(line, copter);
    line.acknowledge(3, MavResult.TEMPORARILY_REJECTED);
    await expect(refused).rejects.toThrow('starting the bootloader of vehicle 3 failed: TEMPORARILY_REJECTED');
    expect(line.hasListener).toBe(false);
  });

  it('may restart before its acknowledgement has left', async () => {
    const line = new Line();
    const started = startBootloader(line, copter);
    await vi.advanceTimersByTimeAsync(3100);
    await expect(started).resolves.toBe(false);
    expect(line.sent).toHaveLength(1);
  });
});
