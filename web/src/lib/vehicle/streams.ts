/** Streams of a vehicle of which some may end while others go on. */

import { Pace } from '$lib/series/Pace';

/** The messages of each stream; any of them renews it. */
const STREAMS = {
  attitude: ['ATTITUDE'],
  position: ['GLOBAL_POSITION_INT'],
  speed: ['VFR_HUD', 'GLOBAL_POSITION_INT'],
  airspeed: ['VFR_HUD'],
  gps: ['GPS_RAW_INT'],
  battery: ['BATTERY_STATUS', 'SYS_STATUS'],
} as const;

export type Stream = keyof typeof STREAMS;

const NAMES = Object.keys(STREAMS) as Stream[];
const NONE: readonly Stream[] = [];

export class StreamWatch {
  private readonly paces = new Map<string, Pace>();

  /** Takes a message of the vehicle's autopilot. */
  take(name: string, time: number): void {
    let pace = this.paces.get(name);
    if (pace === undefined) {
      if (!NAMES.some((stream) => (STREAMS[stream] as readonly string[]).includes(name))) return;
      this.paces.set(name, (pace = new Pace()));
    }
    // A replay that goes back begins again.
    if (pace.time !== null && time < pace.time) pace.clear();
    pace.take(time);
  }

  /** Returns the streams that the vehicle has sent and that are overdue at a time. */
  overdue(now: number): readonly Stream[] {
    const found = NAMES.filter((stream) => {
      const paces = STREAMS[stream].map((name) => this.paces.get(name)).filter((pace) => pace !== undefined);
      return paces.length > 0 && paces.every((pace) => pace.overdue(now) !== null);
    });
    return found.length > 0 ? found : NONE;
  }
}
