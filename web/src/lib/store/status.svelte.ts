/** State of the link to the vehicles and of the session at the station. */

import type { TransportState } from '$lib/transport/Transport';
import type { StatusText } from '$lib/vehicle/Vehicle';

/** Where vehicles come from: the station's server, USB, a link of the page, its demo, or a replayed log. */
export type Source = 'server' | 'serial' | 'link' | 'demo' | 'replay';
export type Role = 'observe' | 'operate' | 'administer';

const MAX_TEXTS = 500;

class Status {
  source: Source | null = $state(null);
  link: TransportState = $state('closed');
  /** Name of the link for people. */
  linkName = $state('');
  /** Reason of the last failure of the link. */
  reason: string | null = $state(null);
  role: Role = $state('administer');
  /** The station asks for a password. */
  needsLogin = $state(false);
  /** Messages a second, of all vehicles. */
  rate = $state(0);
  /** Bytes a second, of messages or not. */
  byteRate = $state(0);
  /** Status texts of all vehicles, the newest last. */
  texts: readonly StatusText[] = $state.raw([]);

  addTexts(texts: readonly StatusText[]): void {
    if (texts.length === 0) return;
    // Those that the station kept are older than those that came since.
    this.texts = [...this.texts, ...texts].sort((one, other) => one.time - other.time).slice(-MAX_TEXTS);
  }
}

export const status = new Status();
