/** The station's WebSocket `/ws`, subprotocol `mavstack.raw.1`; reconnects until it is closed. */

import { BaseTransport } from './Transport';

const RAW_PROTOCOL = 'mavstack.raw.1';
/** Subprotocol that announces a ticket as the next one, so that the ticket is in no URL and no log. */
const TICKET_PROTOCOL = 'ados-ws-ticket';
/** Bytes that may wait to be sent. */
const MAX_BACKLOG = 4096;
const MIN_RETRY_INTERVAL = 500;
const MAX_RETRY_INTERVAL = 4000;

export interface WebSocketOptions {
  /** Returns a new ticket for each connection, or null if the session needs none. */
  readonly ticket?: () => Promise<string | null>;
  readonly makeSocket?: (url: string, protocols: string[]) => WebSocket;
}

export class WebSocketTransport extends BaseTransport {
  readonly name: string;
  private readonly options: WebSocketOptions;
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private interval = MIN_RETRY_INTERVAL;
  private wanted = false;

  /** Creates the transport; `url` is that of the station's `/ws` by default. */
  constructor(url: string = stationSocket(), options: WebSocketOptions = {}) {
    super();
    this.name = url;
    this.options = options;
  }

  async open(): Promise<void> {
    this.wanted = true;
    await this.connect();
  }

  close(): void {
    this.wanted = false;
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
    this.socket?.close();
    this.socket = null;
    this.change('closed');
  }

  send(packets: Uint8Array): void {
    const { socket } = this;
    // A stalled connection takes nothing more: commands and sticks must not arrive late.
    if (socket?.readyState !== 1 || socket.bufferedAmount > MAX_BACKLOG) return;
    socket.send(packets as Uint8Array<ArrayBuffer>);
  }

  private async connect(): Promise<void> {
    this.change('connecting', this.reason);
    let protocols = [RAW_PROTOCOL];
    try {
      const ticket = (await this.options.ticket?.()) ?? null;
      if (ticket !== null) protocols = [TICKET_PROTOCOL, ticket, RAW_PROTOCOL];
    } catch (error) {
      this.retry(error instanceof Error ? error.message : String(error));
      return;
    }
    if (this.wanted) await this.openSocket(protocols);
  }

  private openSocket(protocols: string[]): Promise<void> {
    const make = this.options.makeSocket ?? ((url, names) => new WebSocket(url, names));
    const socket = make(this.name, protocols);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    return new Promise((resolve) => {
      socket.onopen = () => {
        this.interval = MIN_RETRY_INTERVAL;
        this.change('open');
        resolve();
      };
      socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
        if (typeof event.data !== 'string') this.emit(new Uint8Array(event.data));
      };
      socket.onclose = (event) => {
        resolve();
        if (this.socket !== socket) return;
        this.socket = null;
        this.retry(event.reason || 'the station does not answer');
      };
    });
  }

  private retry(reason: string): void {
    if (!this.wanted) return;
    this.change('failed', reason);
    this.timer = setTimeout(() => {
      void this.connect();
    }, this.interval);
    this.interval = Math.min(this.interval * 2, MAX_RETRY_INTERVAL);
  }
}

/** Returns the URL of the station's WebSocket, beside the page. */
export function stationSocket(page: string = location.href): string {
  const url = new URL('ws', page);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  url.search = url.hash = '';
  return url.href;
}
