/** A packet and its time of reception in ms since 1970. */
export interface TimedPacket {
  readonly time: number;
  readonly bytes: Uint8Array;
}

/** The packets that the page saw last, up to a number of bytes. */
export class PacketHistory {
  private packets: TimedPacket[] = [];
  private first = 0;
  private size = 0;
  private readonly maximum: number;

  constructor(maximum = 8 << 20) {
    this.maximum = maximum;
  }

  get length(): number {
    return this.packets.length - this.first;
  }

  /** Adds a packet; its bytes are copied, since a view would keep the whole message of the WebSocket. */
  add(time: number, bytes: Uint8Array): void {
    this.packets.push({ time, bytes: bytes.slice() });
    this.size += bytes.length;
    while (this.size > this.maximum) this.size -= this.packets[this.first++]!.bytes.length;
    if (this.first > 4096 && this.first * 2 > this.packets.length) {
      this.packets = this.packets.slice(this.first);
      this.first = 0;
    }
  }

  list(): readonly TimedPacket[] {
    return this.packets.slice(this.first);
  }

  clear(): void {
    this.packets = [];
    this.first = 0;
    this.size = 0;
  }
}
