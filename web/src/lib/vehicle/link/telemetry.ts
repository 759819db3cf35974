/**
 * The telemetry that the views show, requested from a vehicle that sends less of it.
 *
 * ArduPilot sends little more than heartbeats over USB until a ground station asks for more, and forgets what was asked
 * for when it reboots. So messages are counted, and those that are missing are requested again, ever more rarely where
 * the vehicle does not have them.
 */

import type { VehicleState } from '../Vehicle';
import type { Channel } from './channel';

/** Rates in hertz; those that the station's server requests (TELEMETRY_RATES in server/station.py). */
export const TELEMETRY_RATES: Readonly<Record<string, readonly [id: number, rate: number]>> = {
  ATTITUDE: [30, 10],
  GLOBAL_POSITION_INT: [33, 5],
  VFR_HUD: [74, 5],
  GPS_RAW_INT: [24, 2],
  RC_CHANNELS: [65, 2],
  SYS_STATUS: [1, 1],
  BATTERY_STATUS: [147, 1],
  EXTENDED_SYS_STATE: [245, 1],
  MISSION_CURRENT: [42, 1],
  VIBRATION: [241, 1],
  FENCE_STATUS: [162, 1],
};

/** Messages that only one firmware has. */
const OF_FIRMWARE: Readonly<Partial<Record<VehicleState['firmware'], typeof TELEMETRY_RATES>>> = {
  ardupilot: { EKF_STATUS_REPORT: [193, 1], WIND: [168, 1] },
  px4: { ESTIMATOR_STATUS: [230, 1], WIND_COV: [231, 1] },
};

const SET_MESSAGE_INTERVAL = 511;
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
    for (const [name, [id, rate]] of Object.entries(this.rates)) {
      const count = this.counts.get(name) ?? 0;
      if (count >= (rate * CHECK_INTERVAL * MIN_SHARE) / 1000) this.waits.delete(name);
      else this.request(name, id, rate);
    }
    this.counts.clear();
  }

  private request(name: string, id: number, rate: number): void {
    const wait = this.waits.get(name) ?? { left: 0, all: 0 };
    if (wait.left > 0) {
      this.waits.set(name, { ...wait, left: wait.left - 1 });
      return;
    }
    const all = Math.min(wait.all === 0 ? 1 : wait.all * 2, MAX_CHECKS_BETWEEN);
    this.waits.set(name, { left: all, all });
    this.channel.sendMessage('COMMAND_LONG', { command: SET_MESSAGE_INTERVAL, param1: id, param2: 1e6 / rate });
  }
}
