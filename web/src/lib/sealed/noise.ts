/**
 * The initiator of the Noise handshake `NNpsk0` of sealed links, and the frames of its sessions: X25519, SHA-256 and
 * ChaCha20-Poly1305. Message formats: docs/explanation/sealed-links.md; vectors: tests/security/sealed/vectors.json.
 */

import { chacha20poly1305 } from '@noble/ciphers/chacha.js';
import { x25519 } from '@noble/curves/ed25519.js';
import { hmac } from '@noble/hashes/hmac.js';
import { sha256 } from '@noble/hashes/sha2.js';

export const KEY_SIZE = 32;
const TAG_SIZE = 16;
const PROTOCOL = 'Noise_NNpsk0_25519_ChaChaPoly_SHA256';
const SHARED_KEY_LABEL = 'mavstack sealed link, pre-shared key';
const PROLOGUE = 'mavstack sealed link';

export type Random = (size: number) => Uint8Array;

/** The keys of a session: for frames that are sent and received. */
export interface SessionKeys {
  readonly sending: Uint8Array;
  readonly receiving: Uint8Array;
}

const utf8 = (text: string): Uint8Array => new TextEncoder().encode(text);

export function joined(...parts: readonly Uint8Array[]): Uint8Array {
  const whole = new Uint8Array(parts.reduce((size, part) => size + part.length, 0));
  let position = 0;
  for (const part of parts) {
    whole.set(part, position);
    position += part.length;
  }
  return whole;
}

/** Returns the key of the handshakes that follows from the secret of a URL. */
export function sharedKey(secret: Uint8Array): Uint8Array {
  return hmac(sha256, secret, utf8(SHARED_KEY_LABEL));
}

/** Returns the nonce of a counter: 4 zero bytes and 8 bytes, little-endian. */
export function nonceOf(counter: number): Uint8Array {
  const nonce = new Uint8Array(12);
  new DataView(nonce.buffer).setBigUint64(4, BigInt(counter), true);
  return nonce;
}

function derive(chain: Uint8Array, secret: Uint8Array, count: number): Uint8Array[] {
  const extracted = hmac(sha256, chain, secret);
  const outputs: Uint8Array[] = [];
  for (let number = 1; number <= count; number += 1) {
    outputs.push(hmac(sha256, extracted, joined(outputs.at(-1) ?? new Uint8Array(0), Uint8Array.of(number))));
  }
  return outputs;
}

/** The symmetric state of a handshake. */
class State {
  hash: Uint8Array;
  chain: Uint8Array;
  private key: Uint8Array | null = null;
  private counter = 0;

  constructor(prologue: Uint8Array) {
    this.hash = this.chain = sha256(utf8(PROTOCOL));
    this.mixHash(prologue);
  }

  clone(): State {
    return Object.assign(Object.create(State.prototype) as State, this);
  }

  mixHash(data: Uint8Array): void {
    this.hash = sha256(joined(this.hash, data));
  }

  mixKey(secret: Uint8Array): void {
    const [chain, key] = derive(this.chain, secret, 2);
    this.chain = chain!;
    this.key = key!;
    this.counter = 0;
  }

  mixKeyAndHash(secret: Uint8Array): void {
    const [chain, mixed, key] = derive(this.chain, secret, 3);
    this.chain = chain!;
    this.mixHash(mixed!);
    this.key = key!;
    this.counter = 0;
  }

  encrypt(plain: Uint8Array): Uint8Array {
    const sealed = chacha20poly1305(this.key!, nonceOf(this.counter), this.hash).encrypt(plain);
    this.counter += 1;
    this.mixHash(sealed);
    return sealed;
  }

  /** Throws if the text is forged. */
  decrypt(sealed: Uint8Array): Uint8Array {
    const plain = chacha20poly1305(this.key!, nonceOf(this.counter), this.hash).decrypt(sealed);
    this.counter += 1;
    this.mixHash(sealed);
    return plain;
  }
}

/** The initiating end of one handshake; `header` is the initiate up to its Noise message. */
export class Initiator {
  private readonly state: State;
  private readonly ephemeral: Uint8Array;

  constructor(key: Uint8Array, header: Uint8Array, random: Random) {
    this.ephemeral = random(KEY_SIZE);
    this.state = new State(joined(utf8(PROLOGUE), header));
    this.state.mixKeyAndHash(key);
  }

  firstMessage(): Uint8Array {
    const own = x25519.getPublicKey(this.ephemeral);
    this.state.mixHash(own);
    this.state.mixKey(own);
    return joined(own, this.state.encrypt(new Uint8Array(0)));
  }

  /** Returns the keys of the session; null if the message is forged, and the right one can still be read. */
  readSecond(message: Uint8Array): SessionKeys | null {
    if (message.length !== KEY_SIZE + TAG_SIZE) return null;
    const state = this.state.clone();
    const theirs = message.subarray(0, KEY_SIZE);
    try {
      state.mixHash(theirs);
      state.mixKey(theirs);
      state.mixKey(x25519.getSharedSecret(this.ephemeral, theirs));
      state.decrypt(message.subarray(KEY_SIZE));
    } catch {
      return null;
    }
    const [sending, receiving] = derive(state.chain, new Uint8Array(0), 2);
    return { sending: sending!, receiving: receiving! };
  }
}
