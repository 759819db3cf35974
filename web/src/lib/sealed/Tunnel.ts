/**
 * The end of a sealed link that begins handshakes, without sockets and clock: times are arguments, in ms.
 *
 * It begins one every two minutes, after six seconds without a frame, and when the peer does not know its session. The
 * session in use stays until the next is made.
 */

import { Initiator, joined, sharedKey, type Random } from './noise';
import { isFrame, Session } from './Session';

const [HELLO, CHALLENGE, INITIATE, RESPOND, UNKNOWN] = [1, 2, 3, 4, 5];
const VERSION = 1;
/** A pre-shared key, ChaCha20-Poly1305. */
const SUITE = 0;
const [NONCE_SIZE, COOKIE_SIZE] = [8, 16];
const HELLO_SIZE = 1 + NONCE_SIZE + COOKIE_SIZE;
const EPOCHS = 4;
const REKEY_TIME = 120_000;
const SILENCE = 6000;
const KEEPALIVE = 2000;
const CONFIRM_INTERVAL = 500;
const [FIRST_INTERVAL, MAX_INTERVAL] = [500, 4000];
const MAX_SESSIONS = 2;

interface Attempt {
  readonly nonce: Uint8Array;
  handshake: Initiator | null;
}

export class Tunnel {
  private readonly key: Uint8Array;
  private sessions: readonly Session[] = [];
  private attempt: Attempt | null = null;
  private epoch: number;
  private outgoing: Uint8Array[] = [];
  private interval = FIRST_INTERVAL;
  private nextAttempt = Number.NEGATIVE_INFINITY;
  private lastSent = Number.NEGATIVE_INFINITY;
  private lastReceived = Number.NEGATIVE_INFINITY;
  /** Messages that were not accepted. */
  refused = 0;

  constructor(
    secret: Uint8Array,
    private readonly random: Random = (size) => crypto.getRandomValues(new Uint8Array(size)),
  ) {
    this.key = sharedKey(secret);
    this.epoch = random(1)[0]! % EPOCHS;
  }

  private get current(): Session | null {
    return this.sessions[0] ?? null;
  }

  get isOpen(): boolean {
    return this.current !== null;
  }

  /** Returns the messages that wait to be sent. */
  take(): Uint8Array[] {
    return this.outgoing.splice(0);
  }

  /** Queues content; drops it while there is no session. */
  send(content: Uint8Array, now: number): void {
    const session = this.current;
    if (session === null) return;
    this.lastSent = now;
    this.outgoing.push(session.seal(content));
  }

  /** Returns the content of a received message; null for handshakes and all that is not authentic. */
  receive(message: Uint8Array, now: number): Uint8Array | null {
    if (!isFrame(message)) {
      this.receiveHandshake(message, now);
      return null;
    }
    for (const session of this.sessions) {
      const content = session.open(message);
      if (content === null) continue;
      this.lastReceived = now;
      return content.length > 0 ? content : null;
    }
    this.refused += 1;
    return null;
  }

  /** Begins a handshake or sends an empty frame, if it is time; call it several times a second. */
  tick(now: number): void {
    const session = this.current;
    const due =
      session === null ||
      now >= Math.min(session.started + REKEY_TIME, Math.max(this.lastReceived, session.started) + SILENCE);
    if (due && now >= this.nextAttempt) this.begin(now);
    if (session === null) return;
    if (now - this.lastSent >= (session.isConfirmed ? KEEPALIVE : CONFIRM_INTERVAL)) this.send(new Uint8Array(0), now);
  }

  private begin(now: number): void {
    const nonce = this.random(NONCE_SIZE);
    this.attempt = { nonce, handshake: null };
    this.nextAttempt = now + this.interval;
    this.interval = Math.min(this.interval * 1.6, MAX_INTERVAL);
    const hello = new Uint8Array(HELLO_SIZE);
    hello.set([HELLO!, VERSION, SUITE]);
    hello.set(nonce, 3);
    this.outgoing.push(hello);
  }

  private receiveHandshake(message: Uint8Array, now: number): void {
    const { attempt } = this;
    const nonce = message.slice(1, 1 + NONCE_SIZE);
    const isOurs =
      attempt !== null && nonce.length === NONCE_SIZE && nonce.every((each, index) => each === attempt.nonce[index]);
    if (message[0] === CHALLENGE && isOurs && attempt.handshake === null && message.length === HELLO_SIZE) {
      const header = joined(Uint8Array.of(INITIATE!, VERSION, SUITE, this.epoch), message.slice(1));
      attempt.handshake = new Initiator(this.key, header, this.random);
      this.outgoing.push(joined(header, attempt.handshake.firstMessage()));
    } else if (message[0] === RESPOND && isOurs && attempt.handshake !== null) {
      this.finish(attempt.handshake, message.slice(1 + NONCE_SIZE), now);
    } else if (message[0] === UNKNOWN && this.current !== null) {
      if (now >= this.nextAttempt) this.begin(now);
    } else {
      this.refused += 1;
    }
  }

  private finish(handshake: Initiator, message: Uint8Array, now: number): void {
    const keys = handshake.readSecond(message);
    if (keys === null) {
      this.refused += 1;
      return;
    }
    this.sessions = [new Session(keys, this.epoch, now), ...this.sessions].slice(0, MAX_SESSIONS);
    this.epoch = (this.epoch + 1) % EPOCHS;
    this.attempt = null;
    this.interval = FIRST_INTERVAL;
    this.nextAttempt = now + FIRST_INTERVAL;
    this.send(new Uint8Array(0), now); // It confirms the session at the peer.
  }
}
