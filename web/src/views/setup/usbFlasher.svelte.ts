/** Flashing of a board at a serial port of this computer, by WebSerial. */

import { textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { findAutopilot, startBootloader } from '$lib/flashing/autopilot';
import { BootloaderClient, type FlashPhase } from '$lib/flashing/BootloaderClient';
import { boardName, checkFirmware, type Board } from '$lib/flashing/board';
import { parseFirmware, type FirmwareFile } from '$lib/flashing/firmwareFile';
import { WebSerialTransport } from '$lib/transport/WebSerialTransport';

/** Number of attempts to find a bootloader that may not run. */
const QUICK_ATTEMPTS = 2;

class UsbFlasher {
  firmware: FirmwareFile | null = $state.raw(null);
  board: Board | null = $state.raw(null);
  /** The vehicle whose autopilot runs at the port; null: none does. */
  vehicle: number | null = $state(null);
  isBusy = $state(false);
  phase: FlashPhase | null = $state(null);
  done = $state(0);
  total: number | null = $state(null);
  /** The text about the last success. */
  outcome: string | null = $state(null);
  problem: string | null = $state(null);
  private transport: WebSerialTransport | null = null;
  private client: BootloaderClient | null = null;

  async choose(file: File | undefined): Promise<void> {
    [this.firmware, this.problem, this.outcome] = [null, null, null];
    if (file === undefined) return;
    await this.run(async () => {
      this.firmware = await parseFirmware(file, file.name);
    });
  }

  /** Lets the user choose a port, and looks for a bootloader or an autopilot; must be called from a click. */
  async connect(): Promise<void> {
    this.disconnect();
    const transport = new WebSerialTransport();
    await this.run(async () => {
      await transport.open();
      this.transport = transport;
      const client = new BootloaderClient(transport);
      this.client = client;
      transport.onState((state) => {
        if (state === 'failed' && this.transport === transport) this.lose(transport.reason ?? '');
      });
      try {
        this.board = await client.identify(QUICK_ATTEMPTS);
      } catch (error) {
        if (this.transport !== transport) throw error;
        await this.lookForAutopilot(transport);
      }
    });
    if (this.board === null && this.vehicle === null) this.release();
  }

  private async lookForAutopilot(transport: WebSerialTransport): Promise<void> {
    const found = await findAutopilot(transport);
    if (found === null) throw new Error(t('setup.usbNothing'));
    this.vehicle = found.system;
  }

  /** Lets the autopilot start its bootloader, whose port is another one for the browser. */
  async leaveFirmware(): Promise<void> {
    const { transport, vehicle } = this;
    if (transport === null || vehicle === null) return;
    await this.run(async () => {
      const found = await findAutopilot(transport, vehicle);
      if (found === null) throw new Error(t('setup.usbNothing'));
      const isConfirmed = await startBootloader(transport, found);
      this.disconnect();
      this.outcome = t(isConfirmed ? 'setup.usbBootloaderStarts' : 'setup.usbUnconfirmed');
    });
  }

  /** Checks the file and the board again, and writes the firmware. */
  async flash(): Promise<void> {
    const { client, firmware, board } = this;
    if (client === null || firmware === null || board === null) return;
    // The browser asks before it closes the page.
    const ask = (event: Event): void => event.preventDefault();
    addEventListener('beforeunload', ask);
    await this.run(async () => {
      await client.flash(firmware, board, (phase, done, total) => {
        [this.phase, this.done, this.total] = [phase, done, total || null];
      });
      await client.reboot();
      const name = boardName(board.boardId);
      this.disconnect();
      this.outcome = t('setup.usbDone', { board: name });
    });
    removeEventListener('beforeunload', ask);
    this.phase = null;
  }

  /** The reason why the file does not fit the board; empty: it fits, or one of them is missing. */
  get refusal(): string {
    if (this.firmware === null || this.board === null) return '';
    try {
      checkFirmware(this.firmware, this.board);
      return '';
    } catch (error) {
      return textOf(error);
    }
  }

  disconnect(): void {
    this.release();
    [this.board, this.vehicle, this.problem, this.outcome] = [null, null, null, null];
  }

  /** Lets other parts of the page open the port, unless work is under way. */
  leave(): void {
    if (this.isBusy) return;
    this.release();
    [this.board, this.vehicle] = [null, null];
  }

  private release(): void {
    this.client?.close();
    this.transport?.close();
    [this.client, this.transport] = [null, null];
  }

  private lose(reason: string): void {
    const isWriting = this.phase !== null;
    this.client?.close(isWriting ? `${reason}; ${t('setup.usbStays')}` : reason);
    this.release();
    [this.board, this.vehicle] = [null, null];
    if (!isWriting) this.problem = reason;
  }

  private async run(work: () => Promise<void>): Promise<void> {
    [this.isBusy, this.problem, this.outcome] = [true, null, null];
    try {
      await work();
    } catch (error) {
      this.problem = textOf(error);
    } finally {
      this.isBusy = false;
    }
  }
}

export const usbFlasher = new UsbFlasher();
