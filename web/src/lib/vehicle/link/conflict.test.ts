import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, type SentFields } from '$lib/decoder/Decoder';

import { ConflictDetector } from './conflict';

const START = 1_790_000_000_000;

class Scene {
  readonly detector = new ConflictDetector();
  private readonly encoder = new Encoder(1, 1);
  time = START;

  /** Takes a message after some seconds. */
  take(seconds: number, name: string, fields: SentFields) {
    this.time += seconds * 1000;
    this.detector.take(new Decoder().push(this.encoder.build(name, fields), this.time)[0]!);
    return this.detector.conflict(this.time);
  }

  /** A message of a vehicle that was switched on some seconds before the scene began. */
  attitude(age: number, late = 0) {
    return this.take(0.1, 'ATTITUDE', { time_boot_ms: this.time + 100 - START + age * 1000 - late * 1000 });
  }
}

describe('a conflict of ids on a link of the page', () => {
  it('shows by two clocks that take turns, and ends when one of them is silent', () => {
    const scene = new Scene();
    expect([scene.attitude(60), scene.attitude(9000), scene.attitude(60)]).toEqual([null, null, null]);
    expect(scene.attitude(9000)?.text).toContain(
      'two vehicles use system id 1 on this link (they differ in boot time)',
    );
    expect(scene.attitude(60)).toBe(scene.attitude(9000));
    for (let count = 0; count < 299; count += 1) scene.attitude(60);
    expect(scene.attitude(60)).not.toBeNull();
    for (let count = 0; count < 20; count += 1) scene.attitude(60);
    expect(scene.attitude(60)).toBeNull();
  });

  it('is neither a reboot nor packets that came late', () => {
    const scene = new Scene();
    for (const age of [5000, 5000, 20, 20, 20, 20]) expect(scene.attitude(age)).toBeNull();
    for (const late of [0, 3, 0, 2, 0, 3.5, 0, 0]) expect(scene.attitude(20, late)).toBeNull();
    // One packet that was held up is no second vehicle.
    for (const late of [0, 9, 0, 0]) expect(scene.attitude(20, late)).toBeNull();
  });

  it('shows by two types, and by two unique ids', () => {
    const scene = new Scene();
    const beat = (type: number) => scene.take(0.5, 'HEARTBEAT', { type, autopilot: 3 });
    expect([2, 1, 2].map(beat)).toEqual([null, null, null]);
    expect(beat(1)?.text).toContain('type');
    const other = new Scene();
    const version = (uid: bigint) => other.take(1, 'AUTOPILOT_VERSION', { uid });
    expect([7n, 0n, 8n, 7n].map(version)).toEqual([null, null, null, null]);
    expect(version(8n)?.text).toContain('unique id');
  });

  it('is not what a replay shows that is moved', () => {
    const scene = new Scene();
    scene.attitude(60);
    scene.attitude(9000);
    scene.time = START - 50_000;
    expect([scene.attitude(60), scene.attitude(9000), scene.attitude(60)]).toEqual([null, null, null]);
  });
});
