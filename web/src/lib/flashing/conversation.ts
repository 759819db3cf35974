/** Requests to a bootloader, one after the other, and replies that end with a status. */

import { FlashingError } from './errors';

/** The line to the board. */
export interface BootloaderLine {
  send(data: Uint8Array): void;
  /** Registers the receiver of its bytes; returns the function that removes it. */
  onData(listener: (data: Uint8Array) => void): () => void;
}

export const INSYNC = 0x12;
export const OK = 0x10;
export const INVALID = 0x13;
const TEXTS: ReadonlyMap<number, string> = new Map([
  [0x11, 'FAILED'],
  [INVALID, 'INVALID'],
  [0x14, 'its chip has a fault, and cannot be programmed'],
]);
/** Bytes of a status: INSYNC and the result. */
const STATUS_SIZE = 2;
/** Milliseconds to wait for the reply to a request. */
const REPLY_TIMEOUT = 2000;

/** Returns the bytes of a complete reply, its status included; null while bytes are missing. */
export type ReplySize = (data: Uint8Array) => number | null;

export const fixed =
  (size: number): ReplySize =>
  (data) =>
    data.length >= size + STATUS_SIZE ? size + STATUS_SIZE : null;

/** The size of a reply to a request that old bootloaders refuse; the reply never looks like a refusal. */
export const refusable =
  (size: number): ReplySize =>
  (data) =>
    data.length === STATUS_SIZE && data[0] === INSYNC && data[1] === INVALID ? STATUS_SIZE : fixed(size)(data);

/** The size of a text whose length comes first, in 32 bits. */
export const counted: ReplySize = (data) => {
  if (data.length < 4) return null;
  return fixed(4 + Math.min(numberAt(data, 0), 255))(data);
};

export interface Request {
  readonly data: Uint8Array;
  /** The operation for errors, such as "erasing". */
  readonly operation: string;
  readonly size?: ReplySize;
  /** Milliseconds for the reply. */
  readonly timeout?: number;
}

interface Waiting {
  readonly request: Request;
  readonly timer: ReturnType<typeof setTimeout>;
  resolve(reply: Uint8Array): void;
  reject(error: FlashingError): void;
}

export class Conversation {
  private readonly line: BootloaderLine;
  private readonly endListening: () => void;
  private buffer = new Uint8Array();
  private waiting: Waiting | null = null;
  /** The reason why it ended; null: it has not. */
  private closed: string | null = null;

  constructor(line: BootloaderLine) {
    this.line = line;
    this.endListening = line.onData((data) => this.receive(data));
  }

  /** Ends it; a request that waits fails with the reason. */
  close(reason = 'the port was closed'): void {
    this.endListening();
    this.closed ??= reason;
    const { waiting } = this;
    if (waiting !== null) this.end(waiting).reject(new FlashingError(`${waiting.request.operation} failed: ${reason}`));
  }

  /** Sends a request; resolves to the bytes of its reply before the status. */
  ask(request: Request): Promise<Uint8Array> {
    const { closed } = this;
    if (closed !== null) return Promise.reject(new FlashingError(`${request.operation} failed: ${closed}`));
    return new Promise((resolve, reject) => {
      // Bytes that came while nothing was awaited belong to an earlier request.
      this.buffer = new Uint8Array();
      const timer = setTimeout(() => this.fail(), request.timeout ?? REPLY_TIMEOUT);
      this.waiting = { request, timer, resolve, reject };
      this.line.send(request.data);
    });
  }

  private receive(data: Uint8Array): void {
    const { waiting } = this;
    if (waiting === null) return;
    const all = new Uint8Array(this.buffer.length + data.length);
    all.set(this.buffer);
    all.set(data, this.buffer.length);
    this.buffer = all;
    const size = (waiting.request.size ?? fixed(0))(all);
    if (size === null) return;
    const [mark, status] = [all[size - 2]!, all[size - 1]!];
    this.end(waiting);
    if (mark === INSYNC && status === OK) waiting.resolve(all.slice(0, size - STATUS_SIZE));
    else waiting.reject(errorOf(waiting.request, mark, status));
  }

  private fail(): void {
    const { waiting } = this;
    if (waiting === null) return;
    this.end(waiting);
    const [mark, status] = this.buffer;
    const isRefusal = mark === INSYNC && status !== undefined && TEXTS.has(status);
    waiting.reject(
      isRefusal
        ? errorOf(waiting.request, mark, status)
        : new FlashingError(`${waiting.request.operation} failed: the bootloader does not answer`),
    );
  }

  private end(waiting: Waiting): Waiting {
    clearTimeout(waiting.timer);
    this.waiting = null;
    return waiting;
  }
}

function errorOf({ operation }: Request, mark: number, status: number): FlashingError {
  const text = mark === INSYNC ? TEXTS.get(status) : undefined;
  return text === undefined
    ? new FlashingError(`${operation} failed: the answer is not one of a bootloader`, -1)
    : new FlashingError(`${operation} failed: ${text}, says the bootloader`, status);
}

export function numberAt(data: Uint8Array, at: number): number {
  return new DataView(data.buffer, data.byteOffset, data.byteLength).getUint32(at, true);
}
