/**
 * The latest message of each name, sender by sender, with counts and rates. Changes at most once per animation frame.
 */

import type { DecodedMessage } from '$lib/decoder/Decoder';

export interface LatestMessage {
  readonly message: DecodedMessage;
  readonly count: number;
  /** Messages a second. */
  readonly rate: number;
}

const RATE_WINDOW = 2000;
const MEASURE_INTERVAL = 500;
/** More names come only from noise that looks like packets of unknown messages. */
const MAX_NAMES = 500;

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
    // A replay may go back.
    if (elapsed >= 0 && elapsed < RATE_WINDOW) return;
    const measured = elapsed < 0 ? this.rate : (this.windowCount * 1000) / elapsed;
    this.rate = this.rate === 0 ? measured : this.rate * 0.5 + measured * 0.5;
    if (this.windowCount === 0) this.rate = 0;
    this.windowStart = now;
    this.windowCount = 0;
  }
}

class Messages {
  /** Counts changes; reading it in a component makes the component follow them. */
  version = $state(0);
  /** By system, then by component and name. */
  private readonly systems = new Map<number, Map<string, Entry>>();
  private changed = false;
  private measured = 0;

  /** Takes a message; the store calls it. */
  take(message: DecodedMessage): void {
    let entries = this.systems.get(message.system);
    if (entries === undefined) this.systems.set(message.system, (entries = new Map()));
    const key = `${message.component}/${message.name}`;
    let entry = entries.get(key);
    if (entry === undefined) {
      if (entries.size >= MAX_NAMES) entries.delete(entries.keys().next().value!);
      entries.set(key, (entry = new Entry(message)));
    }
    entry.take(message);
    this.changed = true;
  }

  /** Makes changes visible; the store calls it at most once per animation frame. */
  publish(now: number): void {
    this.measure(now);
    if (this.changed) this.version += 1;
    this.changed = false;
  }

  private measure(now: number): void {
    if (Math.abs(now - this.measured) < MEASURE_INTERVAL) return;
    this.measured = now;
    for (const entries of this.systems.values()) for (const entry of entries.values()) entry.measure(now);
  }

  clear(): void {
    this.systems.clear();
    this.version += 1;
  }

  /** Returns the latest message of a name, of a component or of the one that sent it last; null if there is none. */
  latest(system: number, name: string, component?: number): LatestMessage | null {
    void this.version;
    const entries = this.systems.get(system);
    if (component !== undefined) return entries?.get(`${component}/${name}`) ?? null;
    let best: Entry | null = null;
    for (const entry of entries?.values() ?? []) {
      if (entry.message.name !== name) continue;
      if (best === null || entry.message.time > best.message.time) best = entry;
    }
    return best;
  }

  /** Returns the latest messages of all names, of one system or all. */
  list(system?: number): LatestMessage[] {
    void this.version;
    const systems =
      system === undefined ? [...this.systems.values()] : [this.systems.get(system) ?? new Map<string, Entry>()];
    return systems.flatMap((entries) => [...entries.values()]);
  }
}

export const messages = new Messages();
