/** The handshake and the frames of sealed links reproduce the vectors that Python's tests read too. */

import { readFileSync } from 'node:fs';

import { expect, test } from 'vitest';

import { Initiator, sharedKey } from './noise';
import { Session } from './Session';
import { Tunnel } from './Tunnel';

type Vector = Readonly<Record<string, string>>;

const file = new URL('../../../../tests/security/sealed/vectors.json', import.meta.url);
const vectors = JSON.parse(readFileSync(file, 'utf8')) as readonly Vector[];
const vector = vectors.find(({ suite }) => suite === 'Noise_NNpsk0_25519_ChaChaPoly_SHA256')!;
const bytes = (name: string): Uint8Array => Uint8Array.from(Buffer.from(vector[name]!, 'hex'));
const hex = (data: Uint8Array): string => Buffer.from(data).toString('hex');
const HEADER = 28;

/** The handshake of the vector, whose messages have its random numbers. */
function handshake(): Initiator {
  return new Initiator(bytes('shared_key'), bytes('initiate').slice(0, HEADER), () => bytes('initiator_ephemeral'));
}

test('the messages of the handshake are those of the vector', () => {
  expect(hex(handshake().firstMessage())).toBe(vector.first);
});

test('frames are sealed and opened once', () => {
  const initiator = handshake();
  initiator.firstMessage();
  const session = new Session(initiator.readSecond(bytes('second'))!, 1, 0);
  expect(hex(session.seal(bytes('content')))).toBe(vector.frame);
  expect(hex(session.seal(new Uint8Array(0)))).toBe(vector.next_frame);
  const answer = session.open(bytes('frame_of_responder'));
  expect(answer).not.toBeNull();
  expect(session.open(bytes('frame_of_responder'))).toBeNull();
  expect(session.open(bytes('frame'))).toBeNull();
});

test('a forged second message gives no keys, and the right one still does', () => {
  const initiator = handshake();
  initiator.firstMessage();
  const forged = bytes('second');
  forged[40]! ^= 1;
  expect(initiator.readSecond(forged)).toBeNull();
  expect(initiator.readSecond(new Uint8Array(48))).toBeNull();
  expect(initiator.readSecond(bytes('second'))).not.toBeNull();
});

test('the key follows from the secret', () => {
  const secret = new Uint8Array(32).fill(0x5a);
  expect(sharedKey(secret)).not.toEqual(sharedKey(new Uint8Array(32)));
});

test('a tunnel without an answer repeats its hello ever more slowly, and sends nothing else', () => {
  const tunnel = new Tunnel(new Uint8Array(32));
  const sent: Uint8Array[] = [];
  for (let now = 0; now < 20_000; now += 100) {
    tunnel.tick(now);
    tunnel.send(Uint8Array.of(1), now);
    tunnel.receive(new Uint8Array(60).fill(0x90), now);
    tunnel.receive(Uint8Array.of(2, 1, 2, 3), now);
    sent.push(...tunnel.take());
  }
  expect(tunnel.isOpen).toBe(false);
  expect(sent.every((message) => message.length === 25 && message[0] === 1)).toBe(true);
  expect(sent.length).toBeGreaterThan(4);
  expect(sent.length).toBeLessThan(12);
});
