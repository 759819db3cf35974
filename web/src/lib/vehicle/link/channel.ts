/** One vehicle's end of a link, for the protocols in the page. Times are in ms. */

import { StationError } from '$lib/api/errors';
import type { DecodedMessage, SentFields } from '$lib/decoder/Decoder';

import type { MessageListener, StatusText } from '../Vehicle';

export interface Channel {
  readonly system: number;
  readonly component: number;
  /** Sends a message to the vehicle; its target is filled in. */
  sendMessage(name: string, fields: SentFields): void;
  onMessage(name: string, listener: MessageListener): () => void;
  onStatusText(listener: (text: StatusText) => void): () => void;
}

export interface Request<Answer> {
  /** Operation and its target for errors, such as `reading RTL_ALT of 1/1`. */
  readonly operation: string;
  /** Class of the error of a missing answer. */
  readonly timeoutKind: string;
  /** Names of the messages that may answer. */
  readonly answers: readonly string[];
  /** Sends the request; `attempt` counts from 0. */
  readonly send: (attempt: number) => void;
  /** Returns the answer in a message, or undefined if it is none; throws if it is a refusal. */
  readonly read: (message: DecodedMessage) => Answer | undefined;
  /** Tells whether a message says that the work goes on, so that the answer may come later. */
  readonly continues?: (message: DecodedMessage) => boolean;
  /** Ends the request: it is not sent again, and rejects with the reason of the signal. */
  readonly signal?: AbortSignal | undefined;
  readonly timeout?: number;
  readonly attempts?: number;
}

export const DEFAULT_TIMEOUT = 1000;
export const DEFAULT_ATTEMPTS = 5;
/** Long work tells its progress at least this often. */
export const PROGRESS_TIMEOUT = 10_000;

/** Sends a request until it is answered; rejects if the answer is a refusal, or none comes. */
export function request<Answer>(channel: Channel, wanted: Request<Answer>): Promise<Answer> {
  const { timeout = DEFAULT_TIMEOUT, attempts = DEFAULT_ATTEMPTS, signal } = wanted;
  return new Promise((resolve, reject) => {
    let attempt = 0;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const removes: (() => void)[] = [];
    const end = (finish: () => void): void => {
      clearTimeout(timer);
      for (const remove of removes) remove();
      finish();
    };
    const fail = (error: unknown): void => end(() => reject(error as Error));
    const send = (): void => {
      if (attempt >= attempts) return fail(timeoutOf(wanted, attempts));
      timer = setTimeout(send, timeout);
      attempt += 1;
      try {
        wanted.send(attempt - 1);
      } catch (error) {
        fail(error);
      }
    };
    const take = (message: DecodedMessage): void => {
      if (message.component !== channel.component) return;
      try {
        const answer = wanted.read(message);
        if (answer !== undefined) return end(() => resolve(answer));
      } catch (error) {
        return fail(error);
      }
      if (wanted.continues?.(message) !== true) return;
      clearTimeout(timer);
      timer = setTimeout(() => fail(timeoutOf(wanted, attempt)), PROGRESS_TIMEOUT);
    };
    const abort = (): void => fail(signal?.reason);
    if (signal?.aborted === true) return abort();
    signal?.addEventListener('abort', abort);
    removes.push(() => signal?.removeEventListener('abort', abort));
    for (const name of wanted.answers) removes.push(channel.onMessage(name, take));
    send();
  });
}

function timeoutOf<Answer>(wanted: Request<Answer>, attempts: number): StationError {
  return new StationError(wanted.timeoutKind, `${wanted.operation} failed: no answer to ${attempts} requests`);
}
