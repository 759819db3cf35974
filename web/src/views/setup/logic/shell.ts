/** The shell of the autopilot over SERIAL_CONTROL: lines in, text out. */

import { SerialControlDev, SerialControlFlag } from '$generated';

export const SHELL_DEVICE = SerialControlDev.DEV_SHELL;
const REQUEST = SerialControlFlag.RESPOND | SerialControlFlag.EXCLUSIVE | SerialControlFlag.MULTI;
const DATA_SIZE = 70;

export interface ShellMessage {
  readonly device: number;
  readonly flags: number;
  readonly timeout: number;
  readonly baudrate: number;
  readonly count: number;
  readonly data: readonly number[];
}

function message(data: readonly number[], flags = REQUEST): ShellMessage {
  const padded = [...data, ...Array<number>(DATA_SIZE - data.length).fill(0)];
  return { device: SHELL_DEVICE, flags, timeout: 0, baudrate: 0, count: data.length, data: padded };
}

/** Returns the messages that carry a text, of at most 70 bytes each. */
export function shellMessages(text: string): ShellMessage[] {
  const bytes = [...new TextEncoder().encode(text)];
  const count = Math.max(1, Math.ceil(bytes.length / DATA_SIZE));
  return Array.from({ length: count }, (_, index) => message(bytes.slice(index * DATA_SIZE, (index + 1) * DATA_SIZE)));
}

/** Returns the message that ends the shell. */
export function closeMessage(): ShellMessage {
  return message([], 0);
}

const MAX_CHARACTERS = 100_000;

const ESCAPE = String.fromCharCode(0x1b);
const SEQUENCES = new RegExp(`${ESCAPE}\\[[0-9;?]*[A-Za-z]`, 'g');
/** The beginning of a sequence at the end of a text. */
const OPEN_SEQUENCE = new RegExp(`${ESCAPE}(\\[[0-9;?]*)?$`);

/** The text of a terminal: escape sequences are left out, carriage returns and backspaces take effect. */
export class ShellText {
  text = '';
  private readonly decoder = new TextDecoder();
  private rest = '';

  /** Takes the bytes of an answer. */
  take(count: number, data: ArrayLike<number | bigint>): void {
    const bytes = Uint8Array.from({ length: count }, (_, index) => Number(data[index] ?? 0));
    const all = this.rest + this.decoder.decode(bytes, { stream: true });
    // An escape sequence may arrive in two messages.
    const open = OPEN_SEQUENCE.exec(all)?.index ?? all.length;
    this.rest = all.slice(open);
    const shown = all.slice(0, open).replace(SEQUENCES, '').replace(/\r\n/g, '\n');
    for (const character of shown) {
      if (character === '\b') this.text = this.text.slice(0, -1);
      else if (character === '\r') this.text = this.text.slice(0, this.text.lastIndexOf('\n') + 1);
      else if (character >= ' ' || character === '\n' || character === '\t') this.text += character;
    }
    this.text = this.text.slice(-MAX_CHARACTERS);
  }
}
