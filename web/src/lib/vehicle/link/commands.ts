/** Commands: COMMAND_LONG and COMMAND_INT, retried until COMMAND_ACK, with the vehicle's reasons when refused. */

import { MavResult, MavSeverity } from '$generated';
import { StationError } from '$lib/api/errors';
import { enumName, enumValues, type DecodedMessage } from '$lib/decoder/Decoder';

import type { CommandResult, StatusText } from '../Vehicle';
import { request, type Channel } from './channel';

/** Status texts follow a refusal by this time in ms. */
const REASON_DELAY = 300;
const MAX_SEVERITY_OF_REASONS = MavSeverity.NOTICE;

export interface CommandPlace {
  readonly frame: number;
  readonly latitude: number;
  readonly longitude: number;
  readonly altitude: number;
}

/** Returns the number of a command given by name or number. */
export function commandNumber(command: string | number): number {
  if (typeof command === 'number') return command;
  const number = enumValues('MAV_CMD')?.[command.replace(/^MAV_CMD_/, '')];
  if (number === undefined) throw new StationError('InvalidArgumentError', `no command is named ${command}`);
  return Number(number);
}

/**
 * Sends a command and waits until the vehicle has done or refused it.
 *
 * @param operation - Words for errors, such as `arming`.
 * @param params - Up to seven values; null is NaN, missing ones are zero.
 * @param place - Makes it a COMMAND_INT, whose last three parameters are a place.
 * @param signal - Ends it: it is not sent again.
 */
export async function sendCommand(
  channel: Channel,
  operation: string,
  command: string | number,
  params: readonly (number | null)[],
  place?: CommandPlace,
  signal?: AbortSignal,
): Promise<CommandResult> {
  const id = commandNumber(command);
  const target = `${operation} ${channel.system}/${channel.component}`;
  const texts: StatusText[] = [];
  const remove = channel.onStatusText((text) => texts.push(text));
  let attempts = 0;
  try {
    const answer = await request(channel, {
      operation: target,
      signal,
      timeoutKind: 'CommandTimeout',
      answers: ['COMMAND_ACK'],
      send: (attempt) => {
        attempts = attempt + 1;
        transmit(channel, id, params, attempt, place);
      },
      read: (message) => (isFinal(message, id) ? message : undefined),
      continues: (message) => Number(message.fields.command) === id,
    });
    const result = Number(answer.fields.result);
    const name = enumName('MAV_RESULT', result) ?? String(result);
    if (result === MavResult.ACCEPTED) return { result: name, detail: Number(answer.fields.result_param2), attempts };
    await new Promise((resolve) => setTimeout(resolve, REASON_DELAY));
    throw refusal(target, name, result, texts);
  } finally {
    remove();
  }
}

function isFinal(message: DecodedMessage, command: number): boolean {
  return Number(message.fields.command) === command && Number(message.fields.result) !== MavResult.IN_PROGRESS;
}

function refusal(target: string, name: string, result: number, texts: readonly StatusText[]): StationError {
  const reasons = texts.filter(({ severity }) => severity <= MAX_SEVERITY_OF_REASONS).map(({ text }) => text);
  const why = reasons.length > 0 ? ` (${reasons.join('; ')})` : '';
  return new StationError('CommandDenied', `${target} failed: ${name}${why}`, reasons, result);
}

function transmit(
  channel: Channel,
  command: number,
  params: readonly (number | null)[],
  attempt: number,
  place?: CommandPlace,
): void {
  const fields: Record<string, number> = { command };
  params.forEach((value, index) => (fields[`param${index + 1}`] = value ?? NaN));
  if (place === undefined) {
    channel.sendMessage('COMMAND_LONG', { ...fields, confirmation: attempt });
    return;
  }
  channel.sendMessage('COMMAND_INT', {
    ...fields,
    frame: place.frame,
    x: Math.round(place.latitude * 1e7),
    y: Math.round(place.longitude * 1e7),
    z: place.altitude,
  });
}
