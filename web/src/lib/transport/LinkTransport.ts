/**
 * A vehicle that the page reaches by itself, over a WebSocket without a station: `ws://` and `wss://` of a vehicle or
 * an agent, with a ticket or a token, or `relay://`, the room of a relay, sealed from end to end.
 */

import { StationError } from '$lib/api/errors';
import { Tunnel } from '$lib/sealed/Tunnel';

import { BaseTransport } from './Transport';

const TICKET_PROTOCOL = 'ados-ws-ticket';
const RELAY_PROTOCOL = 'mavstack.relay.1';
const MAX_BACKLOG = 4096;
const TICK_INTERVAL = 100;
const [MIN_RETRY_INTERVAL, MAX_RETRY_INTERVAL] = [500, 8000];

/** An address as the WebSocket needs it. */
export interface LinkAddress {
  /** For people, without ticket, token and secret. */
  readonly name: string;
  readonly url: string;
  readonly protocols: readonly string[];
  /** The secret of a sealed link; null without one. */
  readonly secret: Uint8Array | null;
}

/** Returns the parts of a URL; throws with the reason if no vehicle can be reached by it. */
export function parseLink(text: string): LinkAddress {
  const refuse = (reason: string): never => {
    throw new StationError('InvalidArgumentError', `connecting failed: ${reason}`);
  };
  const match = /^(wss?|relay):\/\/(\S+)$/i.exec(text.trim());
  if (match === null) return refuse('the address must begin with wss://, ws:// or relay://');
  const scheme = match[1]!.toLowerCase();
  const isPlain = scheme === 'ws' || (scheme === 'relay' && /[?&]tls=no(?:&|$)/.test(match[2]!));
  // The ports that a URL may leave out are those of these schemes.
  const base = isPlain ? 'http' : 'https';
  let url: URL;
  try {
    url = new URL(`${base}://${match[2]!}`);
  } catch {
    return refuse(`${scheme}:// is not followed by a host`);
  }
  const take = (name: string): string => {
    const value = url.searchParams.get(name) ?? '';
    url.searchParams.delete(name);
    return value;
  };
  const [ticket, secret] = [take('ticket'), take('secret')];
  take('tls');
  const token = take('token');
  if (token !== '') url.searchParams.set('access_token', token);
  const address = `${isPlain ? 'ws' : 'wss'}${url.href.slice(base.length)}`;
  const name = `${scheme}://${url.host}${url.pathname === '/' ? '' : url.pathname}`;
  if (scheme !== 'relay') {
    return { name, url: address, protocols: ticket === '' ? [] : [TICKET_PROTOCOL, ticket], secret: null };
  }
  if (!/^room1\.[a-z0-9-]{1,32}\.guest\.\d+\.[0-9a-f]{64}$/.test(ticket)) {
    refuse('the address has no ticket of a guest: use the second URL that mav relay invite prints');
  }
  if (!/^[0-9a-f]{64}$/i.test(secret)) refuse('the address has no secret of 64 hexadecimal digits');
  const digits = secret.match(/../g)!.map((digit) => Number.parseInt(digit, 16));
  return { name, url: address, protocols: [RELAY_PROTOCOL, ticket], secret: Uint8Array.from(digits) };
}

export class LinkTransport extends BaseTransport {
  readonly name: string;
  private socket: WebSocket | null = null;
  private tunnel: Tunnel | null = null;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private ticker: ReturnType<typeof setInterval> | null = null;
  private interval = MIN_RETRY_INTERVAL;
  private isWanted = false;

  constructor(
    private readonly address: LinkAddress,
    private readonly makeSocket = (url: string, protocols: string[]) => new WebSocket(url, protocols),
  ) {
    super();
    this.name = address.name;
  }

  open(): Promise<void> {
    this.isWanted = true;
    this.ticker ??= setInterval(() => this.tick(), TICK_INTERVAL);
    this.connect();
    return Promise.resolve();
  }

  close(): void {
    this.isWanted = false;
    if (this.timer !== null) clearTimeout(this.timer);
    if (this.ticker !== null) clearInterval(this.ticker);
    this.timer = this.ticker = null;
    this.socket?.close();
    this.socket = this.tunnel = null;
    this.change('closed');
  }

  send(packets: Uint8Array): void {
    // A stalled connection takes nothing more: commands and sticks must not arrive late.
    if (this.socket?.readyState !== 1 || this.socket.bufferedAmount > MAX_BACKLOG) return;
    if (this.tunnel === null) {
      this.socket.send(packets as Uint8Array<ArrayBuffer>);
      return;
    }
    this.tunnel.send(packets, performance.now());
    this.flush();
  }

  private connect(): void {
    this.change('connecting', this.reason);
    let socket: WebSocket;
    try {
      socket = this.makeSocket(this.address.url, [...this.address.protocols]);
    } catch (error) {
      this.retry(error instanceof Error ? error.message : String(error));
      return;
    }
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.tunnel = this.address.secret === null ? null : new Tunnel(this.address.secret);
      if (this.tunnel === null) this.opened();
      this.tick();
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
      if (typeof event.data !== 'string') this.take(new Uint8Array(event.data));
    };
    socket.onclose = (event) => {
      if (this.socket !== socket) return;
      this.socket = this.tunnel = null;
      this.retry(event.reason || 'no answer, or the ticket is refused');
    };
  }

  private opened(): void {
    this.interval = MIN_RETRY_INTERVAL;
    this.change('open');
  }

  private take(data: Uint8Array): void {
    const { tunnel } = this;
    if (tunnel === null) {
      this.emit(data);
      return;
    }
    const content = tunnel.receive(data, performance.now());
    this.flush();
    if (tunnel.isOpen && this.state !== 'open') this.opened();
    if (content !== null) this.emit(content);
  }

  private tick(): void {
    this.tunnel?.tick(performance.now());
    this.flush();
  }

  private flush(): void {
    for (const message of this.tunnel?.take() ?? []) {
      if (this.socket?.readyState === 1) this.socket.send(message as Uint8Array<ArrayBuffer>);
    }
  }

  private retry(reason: string): void {
    if (!this.isWanted) return;
    this.change('failed', reason);
    this.timer = setTimeout(() => this.connect(), this.interval);
    this.interval = Math.min(this.interval * 2, MAX_RETRY_INTERVAL);
  }
}
