/** Logs of other formats than telemetry logs: the station makes a telemetry log of each, which the page replays. */

import { api as stationApi, type ApiClient } from '$lib/api/client';
import { StationError } from '$lib/api/errors';

/** Suffixes of all logs that the station opens. */
export const LOG_SUFFIXES = '.tlog,.bin,.log,.ulg,.bbl,.bfl,.pcap,.pcapng,.mavlink,.raw';

/** The first bytes of logs that are not telemetry logs; in their middle something may look like packets. */
const BEGINNINGS: readonly (readonly [bytes: readonly number[], words: string])[] = [
  [[0xa3, 0x95], 'an onboard log of ArduPilot'],
  [[0x55, 0x4c, 0x6f, 0x67], 'an onboard log of PX4'],
  [[0x48, 0x20, 0x50, 0x72, 0x6f, 0x64], 'a blackbox log'],
  [[0xd4, 0xc3, 0xb2, 0xa1], 'a capture of network traffic'],
  [[0xa1, 0xb2, 0xc3, 0xd4], 'a capture of network traffic'],
  [[0x4d, 0x3c, 0xb2, 0xa1], 'a capture of network traffic'],
  [[0x0a, 0x0d, 0x0d, 0x0a], 'a capture of network traffic'],
  // A telemetry log begins with a time.
  [[0xfd], 'a stream of packets without times'],
  [[0xfe], 'a stream of packets without times'],
  [[0x46, 0x4d, 0x54, 0x2c], 'an onboard log of ArduPilot as text'],
];

/** Returns the kind of a log in words, null for a telemetry log. */
export function otherLog(data: Uint8Array): string | null {
  return BEGINNINGS.find(([bytes]) => bytes.every((byte, index) => data[index] === byte))?.[1] ?? null;
}

/** Returns the telemetry log of a log of any format; rejects in words where that is not possible. */
export async function telemetryOf(data: Uint8Array, name: string, api: ApiClient = stationApi): Promise<Uint8Array> {
  const words = otherLog(data);
  if (words === null) return data;
  try {
    const body = new Blob([data as Uint8Array<ArrayBuffer>]);
    const response = await api.long('POST', 'replays', undefined, body, { name: safeName(name) });
    return new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    if (!(error instanceof StationError) || !UNAVAILABLE.has(error.kind)) throw error;
    throw new StationError(
      error.kind,
      `replaying ${name} failed: it is ${words}, which only a station can replay (${error.message})`,
    );
  }
}

/** Returns the telemetry log of a recording of the station. */
export async function replayOf(name: string, api: ApiClient = stationApi): Promise<Uint8Array> {
  const response = await api.long('GET', `replays/${encodeURIComponent(name)}`);
  return new Uint8Array(await response.arrayBuffer());
}

/** Errors of a page that runs without a station, or with another server. */
const UNAVAILABLE: ReadonlySet<string> = new Set(['Unreachable', 'InternalError', 'NotFound', 'MethodNotAllowed']);

/** Returns a name that the station takes as that of a file. */
function safeName(name: string): string {
  const plain = name.replace(/[^A-Za-z0-9 _.+-]/g, '_').slice(-100);
  return /^[A-Za-z0-9_]/.test(plain) ? plain : `log_${plain}`;
}
