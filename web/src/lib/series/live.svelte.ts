/**
 * Data that the page receives, for inspection: statistics, watched series, the newest packets, and rows.
 *
 * It begins with the first view that needs it and goes on until the page is left, so that trends and statistics
 * outlive a change of the view.
 */
import { messageInfo, type DecodedMessage } from '$lib/decoder/Decoder';
import { RowsSocket, type RowSample } from '$lib/rows/RowsSocket';
import { Traffic } from '$lib/statistics/Traffic';
import { fleet } from '$lib/store/fleet.svelte';
import { status } from '$lib/store/status.svelte';

import { PacketHistory } from './PacketHistory';
import { SeriesHub } from './SeriesHub';
import { isArray } from './fieldRef';

/** A field that a series can show. */
export interface KnownField {
  readonly name: string;
  readonly unit: string;
  /** Elements of an array; 0 for a single value. */
  readonly length: number;
}

/** Called with the bytes of a frame, and its time in ms. */
type FrameListener = (data: Uint8Array, time: number) => void;

/** More messages of one source come only from noise that looks like packets of unknown messages. */
const MAX_NAMES = 500;

class Live {
  readonly hub = new SeriesHub();
  readonly traffic = new Traffic();
  readonly history = new PacketHistory();
  /** The newest message of each name, by source. */
  readonly latest = new Map<string, Map<string, DecodedMessage>>();
  /** The newest row of each message, by source. */
  readonly rows = new Map<string, Map<string, RowSample>>();
  /** Why rows do not come, null while they do or none are wanted. */
  rowsProblem: string | null = $state(null);
  private readonly units = new Map<string, string>();
  private readonly frames = new Map<string, Set<FrameListener>>();
  private socket: RowsSocket | null = null;
  private started = false;

  /** Begins; without effect when it has begun. */
  start(): void {
    if (this.started) return;
    this.started = true;
    fleet.onMessage('*', (message) => this.take(message));
    $effect.root(() => {
      $effect(() => {
        const wanted = status.source === 'server' && status.link === 'open';
        if (wanted) this.openRows();
        else this.closeRows();
      });
      $effect(() => {
        // Another link: the statistics of the one before say nothing about it.
        void status.source;
        void status.linkName;
        this.clear();
      });
    });
  }

  /** Time in ms since 1970 that plots show at their right edge. */
  now(): number {
    return fleet.now();
  }

  clear(): void {
    this.hub.clear();
    this.traffic.clear();
    this.history.clear();
    this.latest.clear();
  }

  /** Takes a row, also from an example in the page. */
  takeRow(row: RowSample): void {
    let messages = this.rows.get(row.source);
    if (messages === undefined) this.rows.set(row.source, (messages = new Map()));
    messages.set(row.message, row);
    this.hub.feed(row);
    const { data } = row;
    if (data !== undefined) for (const take of this.frames.get(row.source) ?? []) take(data, row.time);
  }

  /** Calls a function with each frame whose bytes a source leaves to scripts; returns the function that ends it. */
  onFrame(source: string, take: FrameListener): () => void {
    const listening = this.frames.get(source) ?? new Set();
    this.frames.set(source, listening.add(take));
    return () => void listening.delete(take);
  }

  /** Remembers the units of the columns of a source of rows. */
  setUnits(source: string, message: string, columns: readonly { name: string; unit: string }[]): void {
    for (const { name, unit } of columns) this.units.set(`${source}:${message}.${name}`, unit);
  }

  /** Returns all sources from which something came. */
  sources(): string[] {
    return [...this.traffic.list().map((each) => each.source), ...this.rows.keys()];
  }

  messagesOf(source: string): string[] {
    const found = [...(this.latest.get(source)?.keys() ?? []), ...(this.rows.get(source)?.keys() ?? [])];
    return found.sort();
  }

  /** Returns the fields of a message with numbers. */
  fieldsOf(source: string, message: string): KnownField[] {
    const info = messageInfo(message);
    if (info !== null && this.latest.get(source)?.has(message)) {
      const numeric = info.fields.filter((field) => field.type !== 'char');
      return numeric.map((field) => ({ name: field.name, unit: field.units ?? '', length: field.arrayLength }));
    }
    const fields = Object.entries(this.rows.get(source)?.get(message)?.fields ?? {});
    return fields.map(([name, value]) => ({
      name,
      unit: this.units.get(`${source}:${message}.${name}`) ?? '',
      length: isArray(value) ? value.length : 0,
    }));
  }

  private take(message: DecodedMessage): void {
    const source = `${message.system}/${message.component}`;
    this.traffic.add(message);
    this.history.add(message.time, message.bytes);
    let messages = this.latest.get(source);
    if (messages === undefined) this.latest.set(source, (messages = new Map()));
    if (messages.size >= MAX_NAMES && !messages.has(message.name)) messages.delete(messages.keys().next().value!);
    messages.set(message.name, message);
    if (!this.hub.wants(message.name)) return;
    this.hub.feed({ source, message: message.name, time: message.time, fields: message.fields });
  }

  private openRows(): void {
    this.socket ??= new RowsSocket(
      (row) => this.takeRow(row),
      (problem) => (this.rowsProblem = problem),
    );
    this.socket.open();
  }

  private closeRows(): void {
    this.socket?.close();
    this.rowsProblem = null;
  }
}

export const live = new Live();
