/** The rows of sources that do not speak MAVLink, as the station sends them (`mavstack.rows.1`). */
import type { Sample } from '$lib/series/fieldRef';
import { stationSocket } from '$lib/transport/WebSocketTransport';

/** A row; `data` are the bytes of a frame that a script reads. */
export interface RowSample extends Sample {
  readonly data?: Uint8Array;
}

const SUBPROTOCOL = 'mavstack.rows.1';
const RECONNECT_INTERVAL = 2000;

/** Reads a message of the WebSocket; null if it is none of rows. */
export function readRow(text: string): RowSample | null {
  const value = JSON.parse(text) as Partial<Sample> & { data?: unknown };
  if (typeof value.source !== 'string' || typeof value.message !== 'string') return null;
  const { source, message, time = 0, fields = {} } = value;
  const row = { source, message, time: time * 1000, fields };
  return typeof value.data === 'string' ? { ...row, data: fromBase64(value.data) } : row;
}

function fromBase64(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}

/**
 * Turns times of the station's clock into times of the browser's, which plots and ages use: they may differ by minutes.
 *
 * The smallest difference that was seen is that of the clocks, plus the shortest way of a row.
 */
export class StationClock {
  private difference: number | null = null;

  /** Returns a time of the station, in ms, as the browser counts. */
  local(time: number, now: number): number {
    this.difference = Math.min(this.difference ?? Infinity, now - time);
    return time + this.difference;
  }
}

export class RowsSocket {
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private readonly onRow: (row: RowSample) => void;
  private readonly onProblem: (problem: string | null) => void;

  constructor(onRow: (row: RowSample) => void, onProblem: (problem: string | null) => void) {
    this.onRow = onRow;
    this.onProblem = onProblem;
  }

  /** Opens the connection, and again when it was lost, until `close`. The cookie of the session is its ticket. */
  open(): void {
    if (this.socket !== null) return;
    const socket = new WebSocket(stationSocket(), SUBPROTOCOL);
    this.socket = socket;
    const clock = new StationClock();
    socket.onopen = () => this.onProblem(null);
    socket.onmessage = (event: MessageEvent<string>) => {
      const row = readRow(event.data);
      if (row !== null) this.onRow({ ...row, time: clock.local(row.time, Date.now()) });
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.onProblem('the station sends no rows');
      this.timer = setTimeout(() => this.open(), RECONNECT_INTERVAL);
    };
  }

  close(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    const { socket } = this;
    this.socket = null;
    socket?.close();
  }
}
