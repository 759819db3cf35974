/** A fleet in the page: a demo without any server. It takes commands, parameters and missions as real vehicles do. */

import { Decoder } from '$lib/decoder/Decoder';

import { MockVehicle } from './mock/MockVehicle';
import { fleetOf, type MockProfile } from './mock/profiles';
import { BaseTransport } from './Transport';

/** Step of the models in ms. */
const STEP = 100;
/** Steps that are made up after a pause of the page, such as a page in the background. */
const MAX_STEPS = 10;

export class MockTransport extends BaseTransport {
  readonly name = 'demo';
  readonly vehicles: readonly MockVehicle[];
  private readonly decoder = new Decoder();
  private outgoing: Uint8Array[] = [];
  private timer: ReturnType<typeof setInterval> | null = null;
  private time = 0;
  private last = 0;

  /** Creates a fleet of seven, or of any number of vehicles. */
  constructor(fleet: number | readonly MockProfile[] = 7) {
    super();
    const profiles = typeof fleet === 'number' ? fleetOf(fleet) : fleet;
    this.vehicles = profiles.map((profile) => new MockVehicle(profile, (packet) => this.outgoing.push(packet)));
  }

  async open(): Promise<void> {
    this.change('open');
    this.last = Date.now();
    this.timer = setInterval(() => this.catchUp(Date.now()), STEP);
  }

  close(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
    this.change('closed');
  }

  send(packets: Uint8Array): void {
    for (const message of this.decoder.push(packets)) {
      for (const vehicle of this.vehicles) vehicle.receive(message);
    }
    // Answers come a little later, as over a link.
    setTimeout(() => this.flush(), 0);
  }

  /** Makes a step of all vehicles. */
  step(): void {
    this.time += STEP;
    for (const vehicle of this.vehicles) vehicle.step(this.time, STEP / 1000);
    this.flush();
  }

  private catchUp(now: number): void {
    const steps = Math.min(Math.round((now - this.last) / STEP), MAX_STEPS);
    for (let count = 0; count < steps; count += 1) this.step();
    if (steps > 0) this.last = now;
  }

  /** Emits what was sent since the last time, in one piece. */
  private flush(): void {
    if (this.outgoing.length === 0) return;
    const packets = this.outgoing;
    this.outgoing = [];
    const data = new Uint8Array(packets.reduce((sum, packet) => sum + packet.length, 0));
    let at = 0;
    for (const packet of packets) {
      data.set(packet, at);
      at += packet.length;
    }
    this.emit(data);
  }
}
