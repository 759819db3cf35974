/**
 * Devices at serial ports of this computer that send lines of values: the page reads them itself, without a station.
 */

import { live } from '$lib/series/live.svelte';
import { WebSerialTransport } from '$lib/transport/WebSerialTransport';
import type { TransportState } from '$lib/transport/Transport';

import { LineReader } from './LineReader';
import { parseRow, parseTemplates, TemplateError, type RowTemplate } from './template';

const SOURCE_NAME = /^[A-Za-z][A-Za-z0-9_-]{0,31}$/;

export class SerialSource {
  received = $state(0);
  /** Lines that fit no template, and lines that were too long. */
  refused = $state(0);
  state: TransportState = $state('connecting');
  private readonly lines = new LineReader();

  constructor(
    readonly name: string,
    private readonly templates: readonly RowTemplate[],
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
    for (const { message, columns } of this.templates) {
      live.setUnits(
        this.name,
        message,
        columns.filter((each) => each !== null),
      );
    }
  }

  close(): void {
    this.transport.close();
  }

  private take(data: Uint8Array, time: number): void {
    const before = this.lines.dropped;
    for (const line of this.lines.feed(data)) {
      const row = parseRow(this.templates, line);
      if (row === null) this.refused++;
      else {
        this.received++;
        live.takeRow({ source: this.name, time, ...row });
      }
    }
    this.refused += this.lines.dropped - before;
  }
}

class SerialSources {
  list: readonly SerialSource[] = $state.raw([]);

  /** Adds a device at a port that the user chooses; throws the reason if that is impossible. */
  async add(
    name: string,
    template: string,
    baudRate: number,
    transport = new WebSerialTransport(baudRate),
  ): Promise<void> {
    if (!SOURCE_NAME.test(name)) throw new TemplateError('the name of a source has letters, digits, _ and -');
    if (this.list.some((each) => each.name === name)) throw new TemplateError(`another source has the name ${name}`);
    const source = new SerialSource(name, parseTemplates(template), transport);
    await source.open();
    this.list = [...this.list, source];
  }

  remove(source: SerialSource): void {
    source.close();
    this.list = this.list.filter((each) => each !== source);
  }
}

export const serialSources = new SerialSources();
