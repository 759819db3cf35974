/**
 * Packets that the page receives, per source and per message: rates, sizes, ages and lost packets.
 *
 * Loss follows from gaps in the sequence numbers of each component, which count to 255 and begin again. A gap
 * of more than half of that is a duplicate, a late packet or a restart of the sender, and is not counted as loss.
 */
const RATE_WINDOW = 5000;
const SEQUENCES = 256;
const MAX_GAP = 128;
/** Time in ms after which the share of lost packets is known. */
const LOSS_TIME = 5000;
/** More messages of one source come only from noise that looks like packets of unknown messages. */
const MAX_MESSAGES = 500;

/** A packet as the statistics need it. */
export interface TrafficPacket {
  readonly system: number;
  readonly component: number;
  readonly sequence: number;
  readonly id: number;
  readonly name: string;
  readonly time: number;
  /** Bytes on the wire. */
  readonly length: number;
}

/** Events of the last seconds: how many there were, and how many bytes. */
export class RateMeter {
  count = 0;
  bytes = 0;
  private readonly slots: { second: number; count: number; bytes: number }[] = [];

  add(time: number, bytes: number): void {
    this.count++;
    this.bytes += bytes;
    const second = Math.floor(time / 1000);
    const last = this.slots.at(-1);
    if (last !== undefined && last.second >= second) {
      last.count++;
      last.bytes += bytes;
    } else {
      this.slots.push({ second, count: 1, bytes });
      if (this.slots.length > RATE_WINDOW / 1000 + 1) this.slots.shift();
    }
  }

  /** Returns packets and bytes per second at a time, over the whole seconds of the last five. */
  rates(now: number): { packets: number; bytes: number } {
    const current = Math.floor(now / 1000);
    const first = current - RATE_WINDOW / 1000;
    const seen = this.slots.filter((slot) => slot.second >= first && slot.second < current);
    const begun = this.slots[0]?.second ?? current;
    const seconds = Math.max(1, Math.min(RATE_WINDOW / 1000, current - begun));
    return { packets: sum(seen, 'count') / seconds, bytes: sum(seen, 'bytes') / seconds };
  }
}

function sum(slots: readonly { count: number; bytes: number }[], key: 'count' | 'bytes'): number {
  return slots.reduce((total, slot) => total + slot[key], 0);
}

/** The statistics of one message of one source. */
export class MessageTraffic {
  readonly meter = new RateMeter();
  lastTime = 0;
  lastLength = 0;

  constructor(
    readonly id: number,
    readonly name: string,
  ) {}

  get count(): number {
    return this.meter.count;
  }

  add(packet: TrafficPacket): void {
    this.meter.add(packet.time, packet.length);
    this.lastTime = packet.time;
    this.lastLength = packet.length;
  }
}

/** The statistics of one component of one system. */
export class SourceTraffic {
  readonly messages = new Map<number, MessageTraffic>();
  readonly meter = new RateMeter();
  lost = 0;
  lastTime = 0;
  private firstTime: number | null = null;
  private sequence: number | null = null;

  constructor(
    readonly system: number,
    readonly component: number,
  ) {}

  /** `system/component`. */
  get source(): string {
    return `${this.system}/${this.component}`;
  }

  get received(): number {
    return this.meter.count;
  }

  /** Share of lost packets, from 0 to 1; null: not known yet. */
  get loss(): number | null {
    if (this.firstTime === null || this.lastTime - this.firstTime < LOSS_TIME) return null;
    return this.lost / (this.received + this.lost);
  }

  add(packet: TrafficPacket): void {
    this.meter.add(packet.time, packet.length);
    this.lastTime = packet.time;
    this.firstTime = Math.min(this.firstTime ?? packet.time, packet.time);
    this.countLoss(packet.sequence);
    let message = this.messages.get(packet.id);
    if (message === undefined) {
      if (this.messages.size >= MAX_MESSAGES) this.messages.delete(this.messages.keys().next().value!);
      this.messages.set(packet.id, (message = new MessageTraffic(packet.id, packet.name)));
    }
    message.add(packet);
  }

  private countLoss(sequence: number): void {
    const gap = this.sequence === null ? 0 : (sequence - this.sequence - 1 + SEQUENCES) % SEQUENCES;
    if (gap >= MAX_GAP) return;
    this.lost += gap;
    this.sequence = sequence;
  }
}

/** All sources, by `system/component`. */
export class Traffic {
  readonly sources = new Map<string, SourceTraffic>();

  add(packet: TrafficPacket): void {
    const key = `${packet.system}/${packet.component}`;
    let source = this.sources.get(key);
    if (source === undefined) {
      this.sources.set(key, (source = new SourceTraffic(packet.system, packet.component)));
    }
    source.add(packet);
  }

  /** Returns the sources by their ids. */
  list(): SourceTraffic[] {
    return [...this.sources.values()].sort((a, b) => a.system - b.system || a.component - b.component);
  }

  clear(): void {
    this.sources.clear();
  }
}
