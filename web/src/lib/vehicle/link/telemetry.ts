/**
 * The telemetry that the views show, requested from a vehicle that sends less of it.
 *
 * ArduPilot sends little more than heartbeats over USB until a ground station asks for more, and forgets what was asked
 * for when it reboots. So messages are counted, and those that are missing are requested again, ever more rarely where
 * the vehicle does not have them.
 */

import { MavCmd } from '$generated';
import { messageInfo } from '$lib/decoder/Decoder';

import type { VehicleState } from '../Vehicle';
import type { Channel } from './channel';

/** Rates in hertz; those that the station's server requests (TELEMETRY_RATES in server/station.py). */
export const TELEMETRY_RATES: Readonly<Record<string, number>> = {
  ATTITUDE: 10,
  GLOBAL_POSITION_INT: 5,
  VFR_HUD: 5,
  GPS_RAW_INT: 2,
  RC_CHANNELS: 2,
  SYS_STATUS: 1,
  BATTERY_STATUS: 1,
  EXTENDED_SYS_STATE: 1,
  MISSION_CURRENT: 1,
  VIBRATION: 1,
  FENCE_STATUS: 1,
};

/** Messages that only one firmware has. */
const OF_FIRMWARE: Readonly<Partial<Record<VehicleState['firmware'], typeof TELEMETRY_RATES>>> = {
  ardupilot: { EKF_STATUS_REPORT: 1, WIND: 1 },
  px4: { ESTIMATOR_STATUS: 1, WIND_COV: 1 },
};

export const CHECK_INTERVAL = 3000;
/** A message that arrives less often than this share of its rate is requested. */
const MIN_SHARE = 0.4;
const MAX_CHECKS_BETWEEN = 20;

export class TelemetryRequests {
  private readonly channel: Channel & { readonly state: Pick<VehicleState, 'firmware'> };
  private readonly counts = new Map<string, number>();
  /** Checks until a message is requested again, and how many there were the last time. */
  private readonly waits = new Map<string, { left: number; all: number }>();
  private timer: ReturnType<typeof setInterval> | null = null;

  constructor(channel: TelemetryRequests['channel']) {
    this.channel = channel;
  }

  start(): void {
    this.timer ??= setInterval(() => this.check(), CHECK_INTERVAL);
  }

  end(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
  }

  /** Counts a message of the vehicle. */
  take(name: string): void {
    this.counts.set(name, (this.counts.get(name) ?? 0) + 1);
  }

  private get rates(): typeof TELEMETRY_RATES {
    return { ...TELEMETRY_RATES, ...OF_FIRMWARE[this.channel.state.firmware] };
  }

  private check(): void {
    for (const [name, rate] of Object.entries(this.rates)) {
      const count = this.counts.get(name) ?? 0;
      if (count >= (rate * CHECK_INTERVAL * MIN_SHARE) / 1000) this.waits.delete(name);
      else this.request(name, rate);
    }
    this.counts.clear();
  }

  private request(name: string, rate: number): void {
    const wait = this.waits.get(name) ?? { left: 0, all: 0 };
    if (wait.left > 0) {
      this.waits.set(name, { ...wait, left: wait.left - 1 });
      return;
    }
    const all = Math.min(wait.all === 0 ? 1 : wait.all * 2, MAX_CHECKS_BETWEEN);
    this.waits.set(name, { left: all, all });
    this.channel.sendMessage('COMMAND_LONG', {
      command: MavCmd.SET_MESSAGE_INTERVAL,
      param1: messageInfo(name)!.id,
      param2: 1e6 / rate,
    });
  }
}
