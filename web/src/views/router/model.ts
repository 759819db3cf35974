/** The state of a router as its control API tells it, and rates between two readings. */
export interface Endpoint {
  readonly name: string;
  readonly url: string;
  readonly state: string;
  readonly reason: string;
  readonly links: readonly string[];
  readonly received: number;
  readonly received_bytes: number;
  readonly sent: number;
  readonly sent_bytes: number;
  readonly lost: number;
  readonly dropped: Readonly<Record<string, number>>;
}

export interface Route {
  readonly system: number;
  readonly component: number;
  readonly endpoints: readonly string[];
  readonly age?: number;
}

export interface RouterState {
  readonly endpoints: readonly Endpoint[];
  readonly routes: readonly Route[];
}

export interface EndpointRates {
  /** Packets a second. */
  readonly received: number;
  readonly sent: number;
  /** Bytes a second. */
  readonly receivedBytes: number;
  readonly sentBytes: number;
}

export const NO_RATES: EndpointRates = { received: 0, sent: 0, receivedBytes: 0, sentBytes: 0 };

/** Returns the rates of an endpoint between two readings; zero after the router began again. */
export function ratesBetween(before: Endpoint | undefined, after: Endpoint, seconds: number): EndpointRates {
  if (before === undefined || !(seconds > 0)) return NO_RATES;
  const rate = (old: number, now: number): number => (now >= old ? (now - old) / seconds : 0);
  return {
    received: rate(before.received, after.received),
    sent: rate(before.sent, after.sent),
    receivedBytes: rate(before.received_bytes, after.received_bytes),
    sentBytes: rate(before.sent_bytes, after.sent_bytes),
  };
}

/** Returns a number of bytes for people. */
export function bytesText(bytes: number): string {
  return bytes < 1000 ? `${Math.round(bytes)} B` : `${(bytes / 1000).toFixed(1)} kB`;
}

export function totalDropped({ dropped }: Endpoint): number {
  return Object.values(dropped).reduce((sum, count) => sum + count, 0);
}

/** Returns the reasons of drops, the most frequent first: `rule 12, loop 3`. */
export function dropReasons({ dropped }: Endpoint): string {
  const reasons = Object.entries(dropped).filter(([, count]) => count > 0);
  return reasons
    .sort(([, a], [, b]) => b - a)
    .map(([reason, count]) => `${reason} ${count}`)
    .join(', ');
}
