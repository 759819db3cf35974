/** The latest message of each name, sender by sender, with counts and rates. Changes once per animation frame. */

import type { DecodedMessage } from '$lib/decoder/Decoder';

export interface LatestMessage {
  readonly message: DecodedMessage;
  readonly count: number;
  /** Messages a second. */
  readonly rate: number;
}

class Entry {
  count = 0;
  rate = 0;
  private windowStart = 0;
  private windowCount = 0;
  message: DecodedMessage;

  constructor(message: DecodedMessage) {
    this.message = message;
    this.windowStart = message.time;
  }

  take(message: DecodedMessage): void {
    this.message = message;
    this.count += 1;
    this.windowCount += 1;
  }

  /** Measures the rate over windows of two seconds, so that slow messages show a steady value. */
  measure(now: number): void {
    const elapsed = now - this.windowStart;
    if (elapsed < 2000) return;
    const measured = (this.windowCount * 1000) / elapsed;
    this.rate = this.rate === 0 ? measured : this.rate * 0.5 + measured * 0.5;
    if (this.windowCount === 0 && elapsed > 2000) this.rate = measured;
    this.windowStart = now;
    this.windowCount = 0;
  }
}

class Messages {
  /** Counts changes; reading it in a component makes the component follow them. */
  version = $state(0);
  private readonly entries = new Map<string, Entry>();
  private changed = false;

  /** Takes a message; the store calls it. */
  take(message: DecodedMessage): void {
    const key = `${message.system}/${message.component}/${message.name}`;
    let entry = this.entries.get(key);
    if (entry === undefined) this.entries.set(key, (entry = new Entry(message)));
    entry.take(message);
    this.changed = true;
  }

  /** Makes changes visible; the store calls it once per animation frame. */
  publish(now: number): void {
    for (const entry of this.entries.values()) entry.measure(now);
    if (this.changed) this.version += 1;
    this.changed = false;
  }

  clear(): void {
    this.entries.clear();
    this.version += 1;
  }

  /** Returns the latest message of a name, of a component or of the one that sent it last; null if there is none. */
  latest(system: number, name: string, component?: number): LatestMessage | null {
    void this.version;
    if (component !== undefined) return this.entries.get(`${system}/${component}/${name}`) ?? null;
    let best: Entry | null = null;
    for (const entry of this.entries.values()) {
      const { message } = entry;
      if (message.system !== system || message.name !== name) continue;
      if (best === null || message.time > best.message.time) best = entry;
    }
    return best;
  }

  /** Returns the latest messages of all names, of one system or all. */
  list(system?: number): LatestMessage[] {
    void this.version;
    return [...this.entries.values()].filter((entry) => system === undefined || entry.message.system === system);
  }
}

export const messages = new Messages();
