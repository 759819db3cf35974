/**
 * Devices at serial ports of this computer that send lines of values or frames: the page reads them itself, without a
 * station.
 */

import { type FrameDecoder, FrameReader } from '$lib/frames/decoder';
import { live } from '$lib/series/live.svelte';
import { WebSerialTransport } from '$lib/transport/WebSerialTransport';
import type { TransportState } from '$lib/transport/Transport';

import { LineRows } from './LineRows';
import { parseTemplates, TemplateError } from './template';

const SOURCE_NAME = /^[A-Za-z][A-Za-z0-9_-]{0,31}$/;

/** How the bytes of a device are read: a template of lines, or a decoder of frames; null leaves them to scripts. */
export type Format = { readonly template: string } | { readonly decoder: FrameDecoder | null };

interface Columns {
  readonly message: string;
  readonly columns: readonly { readonly name: string; readonly unit: string }[];
}

export class SerialSource {
  received = $state(0);
  /** Lines and frames that were wrong or too long, and those that nothing fits. */
  refused = $state(0);
  state: TransportState = $state('connecting');

  constructor(
    readonly name: string,
    private readonly reader: LineRows | FrameReader,
    private readonly messages: readonly Columns[],
    private readonly transport: WebSerialTransport,
  ) {
    transport.onState((state) => (this.state = state));
    transport.onData((data, time) => this.take(data, time));
  }

  get port(): string {
    return this.transport.name;
  }

  /** Opens the port, which the user chooses; must be called from a click. */
  async open(): Promise<void> {
    await this.transport.open();
    for (const { message, columns } of this.messages) live.setUnits(this.name, message, columns);
  }

  close(): void {
    this.transport.close();
  }

  private take(data: Uint8Array, time: number): void {
    for (const row of this.reader.feed(data)) {
      this.received++;
      live.takeRow({ source: this.name, time, ...row });
    }
    this.refused = this.reader.refused;
  }
}

function readerOf(format: Format): [LineRows | FrameReader, readonly Columns[]] {
  if ('decoder' in format) {
    const messages = format.decoder?.messages ?? [];
    return [new FrameReader(format.decoder), messages.map(({ name, fields }) => ({ message: name, columns: fields }))];
  }
  const templates = parseTemplates(format.template);
  const columns = templates.map(({ message, columns: all }) => ({
    message,
    columns: all.filter((each) => each !== null),
  }));
  return [new LineRows(templates), columns];
}

class SerialSources {
  list: readonly SerialSource[] = $state.raw([]);

  /** Adds a device at a port that the user chooses; throws the reason if that is impossible. */
  async add(
    name: string,
    format: Format,
    baudRate: number,
    transport = new WebSerialTransport(baudRate),
  ): Promise<void> {
    if (!SOURCE_NAME.test(name)) throw new TemplateError('the name of a source has letters, digits, _ and -');
    if (this.list.some((each) => each.name === name)) throw new TemplateError(`another source has the name ${name}`);
    const source = new SerialSource(name, ...readerOf(format), transport);
    await source.open();
    this.list = [...this.list, source];
  }

  remove(source: SerialSource): void {
    source.close();
    this.list = this.list.filter((each) => each !== source);
  }
}

export const serialSources = new SerialSources();
