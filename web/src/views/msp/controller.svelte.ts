/** The flight controller at a serial port of this computer, which speaks MSP. */

import { textOf } from '$lib/api/errors';
import type { MspFields } from '$lib/msp/codec';
import { MspClient, type Identity } from '$lib/msp/MspClient';
import { WebSerialTransport } from '$lib/transport/WebSerialTransport';
import { t } from '$lib/i18n';

class Controller {
  identity: Identity | null = $state.raw(null);
  isConnecting = $state(false);
  problem: string | null = $state(null);
  /** Values were set that a restart reverts. */
  hasUnsaved = $state(false);
  private client: MspClient | null = null;
  private transport: WebSerialTransport | null = null;

  get isInav(): boolean {
    return this.identity?.variant === 'INAV';
  }

  /** Lets the user choose a port, and reads what is there; must be called from a click. */
  async connect(baudRate: number): Promise<void> {
    this.disconnect();
    [this.isConnecting, this.problem] = [true, null];
    const transport = new WebSerialTransport(baudRate);
    try {
      await transport.open();
      const client = new MspClient(transport);
      [this.transport, this.client] = [transport, client];
      transport.onState((state) => {
        if (this.transport === transport) void this.follow(state, transport);
      });
      this.identity = await client.identify();
    } catch (error) {
      this.disconnect();
      transport.close();
      this.problem = textOf(error);
    } finally {
      this.isConnecting = false;
    }
  }

  /** A restart unplugs the port for a moment; then everything is read again. */
  private async follow(state: string, transport: WebSerialTransport): Promise<void> {
    if (state === 'failed') {
      this.problem = t('msp.lost', { reason: transport.reason ?? '' });
      this.identity = null;
      return;
    }
    if (state !== 'open') return;
    this.client?.close();
    this.client = new MspClient(transport);
    try {
      this.identity = await this.client.identify();
      [this.problem, this.hasUnsaved] = [null, false];
    } catch (error) {
      this.problem = textOf(error);
    }
  }

  disconnect(): void {
    this.client?.close();
    this.transport?.close();
    [this.client, this.transport, this.identity, this.problem] = [null, null, null, null];
    this.hasUnsaved = false;
  }

  has(message: string): boolean {
    return this.client?.has(message) ?? false;
  }

  get(message: string, request: { name: string; fields: MspFields } | null = null): Promise<MspFields> {
    return this.need().get(message, request);
  }

  async set(message: string, fields: MspFields): Promise<void> {
    await this.need().set(message, fields);
    this.hasUnsaved = true;
  }

  async save(): Promise<void> {
    await this.need().save();
    this.hasUnsaved = false;
  }

  async reboot(): Promise<void> {
    await this.need().reboot();
    this.hasUnsaved = false;
  }

  cli(line: string): Promise<string> {
    return this.need().cli(line);
  }

  get hasCli(): boolean {
    return this.client?.hasCli ?? false;
  }

  private need(): MspClient {
    if (this.client === null) throw new Error('no flight controller is connected');
    return this.client;
  }
}

export const controller = new Controller();
