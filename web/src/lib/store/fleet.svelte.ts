/**
 * The one store: transport → decoder → vehicles and latest messages.
 *
 * Messages are taken as they arrive, so that protocols answer at once; what components read changes at most once per
 * animation frame, and less often for large fleets.
 */

import { MavAutopilot, MavState, MavType } from '$generated';
import { Decoder, Encoder, type DecodedMessage, type SentFields } from '$lib/decoder/Decoder';
import type { Transport } from '$lib/transport/Transport';
import type { ObservedVehicle, Send } from '$lib/vehicle/ObservedVehicle.svelte';
import type { MessageListener, StatusText, Vehicle } from '$lib/vehicle/Vehicle';
import { isAutopilot } from '$lib/vehicle/vehicleType';

import { messages } from './messages.svelte';
import { status, type Source } from './status.svelte';

export type ActingVehicle = Vehicle & ObservedVehicle;
export type MakeVehicle = (heartbeat: DecodedMessage, send: Send) => ActingVehicle;

/** Interval of the ground station's own heartbeat. */
const HEARTBEAT_INTERVAL = 1000;
/** Time in ms after the first vehicle in which others of the same link are found. */
const FINDING_TIME = 3000;
/** Pages in the background have no animation frames. */
const BACKGROUND_INTERVAL = 1000;
/** Each vehicle of a larger fleet adds a ms to the interval in which all are shown: each frame would have some news. */
const MAX_SMALL_FLEET = 12;
const MAX_INTERVAL = 100;
/** The time of a frame in ms. */
const FRAME = 1000 / 60;

class Fleet {
  /** All vehicles by system id. */
  vehicles: readonly Vehicle[] = $state.raw([]);
  selectedSystem: number | null = $state(null);
  selected: Vehicle | null = $derived(this.vehicles.find((vehicle) => vehicle.system === this.selectedSystem) ?? null);

  private readonly known = new Map<number, ActingVehicle>();
  private readonly listeners = new Map<string, Set<MessageListener>>();
  private encoder = new Encoder();
  private decoder = new Decoder();
  private transport: Transport | null = null;
  private ends: (() => void)[] = [];
  private texts: StatusText[] = [];
  private isScheduled = false;
  private counted = 0;
  private bytes = 0;
  private chosen = false;
  /** When the first vehicle was found. */
  private firstFound = 0;
  private published = 0;
  private countedSince = 0;

  /** Leaves the present link and shows the vehicles of another one. */
  async connect(transport: Transport, source: Source, makeVehicle: MakeVehicle): Promise<void> {
    this.disconnect();
    this.transport = transport;
    this.decoder = new Decoder();
    status.source = source;
    status.linkName = transport.name;
    const follow = (): void => {
      status.link = transport.state;
      status.reason = transport.reason;
    };
    this.ends = [
      transport.onState(follow),
      transport.onData((data, time) => {
        this.bytes += data.length;
        for (const message of this.decoder.push(data, time)) this.take(message, makeVehicle, transport);
      }),
      this.every(BACKGROUND_INTERVAL, () => this.publish()),
    ];
    if (source === 'serial' || source === 'link' || source === 'demo') {
      this.ends.push(this.every(HEARTBEAT_INTERVAL, () => this.sendHeartbeat()));
    }
    try {
      await transport.open();
    } finally {
      // Another link may have been chosen in the meantime.
      if (this.transport === transport) follow();
    }
  }

  /** Closes the link and forgets its vehicles. */
  disconnect(): void {
    for (const end of this.ends) end();
    this.ends = [];
    this.transport?.close();
    this.transport = null;
    for (const vehicle of this.known.values()) vehicle.dispose();
    this.known.clear();
    this.vehicles = [];
    this.selectedSystem = null;
    this.chosen = false;
    this.texts = [];
    this.counted = this.bytes = 0;
    messages.clear();
    status.source = null;
    status.link = 'closed';
    status.texts = [];
    status.rate = status.byteRate = 0;
  }

  select(system: number): void {
    this.chosen = true;
    this.selectedSystem = system;
  }

  vehicle(system: number): Vehicle | null {
    return this.known.get(system) ?? null;
  }

  /** Returns the time that the views show in ms since 1970: that of the recording in a replay. */
  now(): number {
    return this.transport?.now() ?? Date.now();
  }

  /** Sends a message by its name, from the ground station. */
  send(name: string, fields: SentFields): void {
    this.transport?.send(this.encoder.build(name, fields));
  }

  /** Registers a listener for messages of all vehicles by name, or all (`*`), as they arrive. */
  onMessage(name: string, listener: MessageListener): () => void {
    let listeners = this.listeners.get(name);
    if (listeners === undefined) this.listeners.set(name, (listeners = new Set()));
    listeners.add(listener);
    return () => listeners.delete(listener);
  }

  private take(message: DecodedMessage, makeVehicle: MakeVehicle, transport: Transport): void {
    this.counted += 1;
    messages.take(message);
    let vehicle = this.known.get(message.system);
    if (vehicle === undefined && isVehicleHeartbeat(message)) {
      // A vehicle of a link that was left must not reach one with its id on the next link.
      vehicle = makeVehicle(message, (name, fields) => {
        if (this.transport === transport) this.send(name, fields);
      });
      this.add(vehicle);
    }
    const text = vehicle?.take(message) ?? null;
    if (text !== null) this.texts.push(text);
    for (const name of [message.name, '*']) {
      for (const listener of this.listeners.get(name) ?? []) listener(message);
    }
    this.schedule();
  }

  private add(vehicle: ActingVehicle): void {
    this.known.set(vehicle.system, vehicle);
    this.vehicles = [...this.known.values()].sort((one, other) => one.system - other.system);
    // Vehicles are found in any order, and the first of the list is selected. Later the selection is the user's: a
    // vehicle that is switched on must not take the place of the one that is flown.
    const now = Date.now();
    if (this.selectedSystem === null) this.firstFound = now;
    if (!this.chosen && now - this.firstFound < FINDING_TIME) this.selectedSystem = this.vehicles[0]!.system;
  }

  /** Publishes in the next frame of which the last publication is an interval ago. */
  private schedule(): void {
    if (this.isScheduled || typeof requestAnimationFrame === 'undefined') return;
    this.isScheduled = true;
    // Frames that are asked for cost time even if they show nothing new.
    const wait = this.published + this.interval - performance.now() - FRAME;
    if (wait > 0) setTimeout(() => this.publishInFrame(), wait);
    else this.publishInFrame();
  }

  private publishInFrame(): void {
    requestAnimationFrame((time) => {
      if (time - this.published < this.interval) return this.publishInFrame();
      this.isScheduled = false;
      this.published = time;
      this.publish();
    });
  }

  private get interval(): number {
    return this.known.size > MAX_SMALL_FLEET ? Math.min(this.known.size, MAX_INTERVAL) : 0;
  }

  /** Makes what arrived visible to components. */
  publish(now: number = this.now()): void {
    for (const vehicle of this.known.values()) {
      vehicle.publish(now);
      this.texts.push(...vehicle.takeLearned());
    }
    messages.publish(now);
    status.addTexts(this.texts.splice(0));
    const elapsed = Date.now() - this.countedSince;
    if (elapsed < 1000) return;
    status.rate = this.countedSince === 0 ? 0 : (this.counted * 1000) / elapsed;
    status.byteRate = this.countedSince === 0 ? 0 : (this.bytes * 1000) / elapsed;
    this.counted = this.bytes = 0;
    this.countedSince = Date.now();
  }

  private every(interval: number, action: () => void): () => void {
    const timer = setInterval(action, interval);
    return () => clearInterval(timer);
  }

  private sendHeartbeat(): void {
    this.send('HEARTBEAT', {
      type: MavType.GCS,
      autopilot: MavAutopilot.INVALID,
      system_status: MavState.ACTIVE,
    });
  }
}

/** Whether a message shows a vehicle; over a link of high latency it sends HIGH_LATENCY2 in place of heartbeats. */
function isVehicleHeartbeat(message: DecodedMessage): boolean {
  if (message.name !== 'HEARTBEAT' && message.name !== 'HIGH_LATENCY2') return false;
  return isAutopilot(Number(message.fields.type), Number(message.fields.autopilot));
}

export const fleet = new Fleet();
