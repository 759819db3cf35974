/** Follows what the station knows of conflicts of system ids: the packets of both vehicles look like those of one. */

import { api as stationApi, type ApiClient } from '$lib/api/client';
import type { ServerIdentity } from '$lib/vehicle/ServerVehicle';

/** A vehicle that takes the facts of the station. */
interface Follower {
  takeFacts(facts: ServerIdentity): void;
}

const INTERVAL = 2000;

export class ConflictWatch {
  private timer: ReturnType<typeof setTimeout> | null = null;
  private readonly find: (system: number) => object | null;
  private readonly isReady: () => boolean;
  private readonly api: ApiClient;

  /**
   * Creates the watch.
   *
   * @param find - Returns the vehicle of a system id.
   * @param isReady - Returns whether the station can be asked now.
   */
  constructor(find: ConflictWatch['find'], isReady: ConflictWatch['isReady'], api: ApiClient = stationApi) {
    [this.find, this.isReady, this.api] = [find, isReady, api];
  }

  start(): void {
    this.stop();
    this.timer = setTimeout(() => void this.read(), INTERVAL);
  }

  stop(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
  }

  private async read(): Promise<void> {
    const { timer } = this;
    try {
      if (this.isReady()) this.take(await this.api.get<readonly ServerIdentity[]>('vehicles'));
    } catch {
      // The link tells that the station does not answer.
    }
    // Stopped, or started again, in the meantime.
    if (this.timer === timer) this.start();
  }

  private take(all: readonly ServerIdentity[]): void {
    for (const facts of all) {
      const vehicle = this.find(facts.system);
      if (vehicle !== null && 'takeFacts' in vehicle) (vehicle as Follower).takeFacts(facts);
    }
  }
}
