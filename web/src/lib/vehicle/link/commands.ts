/** Commands: COMMAND_LONG and COMMAND_INT, retried until COMMAND_ACK, with the vehicle's reasons when refused. */

import { MavResult, MavSeverity } from '$generated';
import { StationError } from '$lib/api/errors';
import { enumName, enumValues } from '$lib/decoder/Decoder';

import type { CommandResult, StatusText } from '../Vehicle';
import { request, type Channel } from './channel';
import { frameOf, scaleOf, toInteger } from './coordinates';

/** Status texts follow a refusal by this time in ms. */
const REASON_DELAY = 300;
const MAX_SEVERITY_OF_REASONS = MavSeverity.NOTICE;

/** Refusals of the message, not of the command. */
const OTHER_FORM: ReadonlySet<number> = new Set([
  MavResult.COMMAND_LONG_ONLY,
  MavResult.COMMAND_INT_ONLY,
  MavResult.COMMAND_UNSUPPORTED_MAV_FRAME,
]);

export interface CommandPlace {
  readonly frame: number;
  /** Degrees; NaN: the vehicle chooses. */
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
  const floats: Form = { command: id, send: asFloats(channel, id, params, place) };
  const integers: Form = { command: id, send: asIntegers(channel, id, params, place) };
  const [first, other] = place === undefined ? [floats, integers] : [integers, floats];
  try {
    let answer = await ask(channel, target, first, signal);
    let { attempts } = answer;
    if (OTHER_FORM.has(answer.result)) {
      answer = await ask(channel, target, other, signal);
      attempts += answer.attempts;
    }
    const { result, detail } = answer;
    const name = enumName('MAV_RESULT', result) ?? String(result);
    if (result === MavResult.ACCEPTED) return { result: name, detail, attempts };
    await new Promise((resolve) => setTimeout(resolve, REASON_DELAY));
    throw refusal(target, name, result, texts);
  } finally {
    remove();
  }
}

interface Answer {
  readonly result: number;
  readonly detail: number;
  readonly attempts: number;
}

/** Sends a command in one form until it is carried out or refused. */
function ask(channel: Channel, operation: string, { command, send }: Form, signal?: AbortSignal): Promise<Answer> {
  let attempts = 0;
  let isRunning = false;
  return request(channel, {
    operation,
    signal,
    timeoutKind: 'CommandTimeout',
    answers: ['COMMAND_ACK'],
    send: (attempt) => {
      attempts = attempt + 1;
      send(attempt);
    },
    read: ({ fields }) => {
      if (Number(fields.command) !== command) return undefined;
      const [result, detail] = [Number(fields.result), Number(fields.result_param2)];
      // A repeated request is rejected while the first one is carried out.
      const isRepetition = result === MavResult.TEMPORARILY_REJECTED && (isRunning || attempts > 1);
      const isProgress = result === MavResult.IN_PROGRESS || isRepetition;
      isRunning ||= isProgress;
      return isProgress ? undefined : { result, detail, attempts };
    },
    continues: ({ fields }) => Number(fields.command) === command,
  });
}

function refusal(target: string, name: string, result: number, texts: readonly StatusText[]): StationError {
  const reasons = texts.filter(({ severity }) => severity <= MAX_SEVERITY_OF_REASONS).map(({ text }) => text);
  const why = reasons.length > 0 ? ` (${reasons.join('; ')})` : '';
  return new StationError('CommandDenied', `${target} failed: ${name}${why}`, reasons, result);
}

/** A command in one of its two messages. */
interface Form {
  readonly command: number;
  /** Sends it; `confirmation` counts from 0 with each repetition. */
  readonly send: (confirmation: number) => void;
}

function numbered(params: readonly (number | null)[]): Record<string, number> {
  return Object.fromEntries(params.map((value, index) => [`param${index + 1}`, value ?? NaN]));
}

/** Returns the form COMMAND_LONG, whose place has the precision of a float. */
function asFloats(
  channel: Channel,
  command: number,
  params: readonly (number | null)[],
  place?: CommandPlace,
): Form['send'] {
  const all = place === undefined ? params : [...withFour(params), place.latitude, place.longitude, place.altitude];
  return (confirmation) => channel.sendMessage('COMMAND_LONG', { command, ...numbered(all), confirmation });
}

/** Returns the form COMMAND_INT. */
function asIntegers(
  channel: Channel,
  command: number,
  params: readonly (number | null)[],
  place?: CommandPlace,
): Form['send'] {
  const frame = place?.frame ?? frameOf(command);
  const [x = 0, y = 0, z = 0] = place ? [place.latitude, place.longitude, place.altitude] : params.slice(4);
  const scale = scaleOf(command, frame);
  const coordinates = { x: toInteger(x, scale), y: toInteger(y, scale), z: z ?? NaN };
  return () => channel.sendMessage('COMMAND_INT', { command, ...numbered(withFour(params)), frame, ...coordinates });
}

function withFour(params: readonly (number | null)[]): (number | null)[] {
  return Array.from({ length: 4 }, (_, index) => (index < params.length ? params[index]! : 0));
}
