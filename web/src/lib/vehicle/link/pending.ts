/**
 * Commands of one vehicle that wait for their answers.
 *
 * A command whose packet was lost is sent again after a second. Where the pilot has given a later one in the
 * meantime, that would undo it: a vehicle that was disarmed would arm. So a later command ends the earlier one.
 */

import { MavCmd } from '$generated';
import { StationError } from '$lib/api/errors';

/** Commands for different messages do not replace each other. */
const BY_MESSAGE: ReadonlySet<number> = new Set([MavCmd.SET_MESSAGE_INTERVAL, MavCmd.REQUEST_MESSAGE]);

export class PendingCommands {
  private readonly commands = new Map<string, AbortController>();
  private action = new AbortController();

  /** Ends the pilot's earlier action; returns the signal that ends the new one. */
  startAction(): AbortSignal {
    this.action.abort(replaced());
    this.action = new AbortController();
    return this.action.signal;
  }

  /** Sends a command by `send`; a later one with its number, or the end of its action, ends it. */
  async run<Result>(
    command: number,
    params: readonly (number | null)[],
    action: AbortSignal | undefined,
    send: (signal: AbortSignal) => Promise<Result>,
  ): Promise<Result> {
    const key = BY_MESSAGE.has(command) ? `${command}/${params[0]}` : String(command);
    this.commands.get(key)?.abort(replaced());
    const controller = new AbortController();
    this.commands.set(key, controller);
    try {
      return await send(action === undefined ? controller.signal : AbortSignal.any([controller.signal, action]));
    } finally {
      if (this.commands.get(key) === controller) this.commands.delete(key);
    }
  }

  /** Ends all: the link was left. */
  end(): void {
    const reason = new StationError('Cancelled', 'the link to the vehicle was closed');
    this.action.abort(reason);
    for (const controller of this.commands.values()) controller.abort(reason);
  }
}

function replaced(): StationError {
  return new StationError('Cancelled', 'a later command replaced this one');
}
