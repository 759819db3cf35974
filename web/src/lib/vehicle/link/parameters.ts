/** The parameter protocol: one by name, all with what got lost requested again, and setting. */

import { StationError } from '$lib/api/errors';
import { enumName, fieldBytes, type DecodedMessage } from '$lib/decoder/Decoder';

import type { Parameter, ProgressListener } from '../Vehicle';
import { request, type Channel } from './channel';
import { decodeValue, encodeValue, floatText, isSame, typeName, type ParameterEncoding } from './parameterValue';

/** Silence in ms after which missing parameters are requested one by one. */
const LIST_TIMEOUT = 1500;
const MAX_ROUNDS_WITHOUT_PROGRESS = 5;
const MISSING_PER_ROUND = 20;
const MAX_NAME_LENGTH = 16;

/** Returns the parameter of a PARAM_VALUE. */
export function parameterOf(message: DecodedMessage, encoding: ParameterEncoding): Parameter {
  const { param_id: name, param_type: type } = message.fields;
  const value = decodeValue(fieldBytes(message, 'param_value'), Number(type), encoding);
  const kind = typeName(Number(type));
  return { name: String(name), value, text: kind === 'REAL32' ? floatText(value) : String(value), type: kind };
}

/** Reads one parameter. */
export async function readParameter(channel: Channel, name: string, encoding: ParameterEncoding): Promise<Parameter> {
  return parameterOf(await readMessage(channel, name), encoding);
}

function readMessage(channel: Channel, name: string): Promise<DecodedMessage> {
  if (name === '' || name.length > MAX_NAME_LENGTH) {
    throw new StationError('InvalidArgumentError', `the name of a parameter has 1 to 16 characters, got '${name}'`);
  }
  const operation = `reading ${name} of ${channel.system}/${channel.component}`;
  return request(channel, {
    operation,
    timeoutKind: 'ParameterTimeout',
    answers: ['PARAM_VALUE', 'PARAM_ERROR'],
    send: () => channel.sendMessage('PARAM_REQUEST_READ', { param_id: name, param_index: -1 }),
    read: (message) => (isAbout(message, name, operation) ? message : undefined),
  });
}

/** Returns whether a message is about a parameter; throws if it is a refusal. */
function isAbout(message: DecodedMessage, name: string, operation: string): boolean {
  if (message.fields.param_id !== name) return false;
  if (message.name !== 'PARAM_ERROR') return true;
  // A request by index concerns another parameter, whatever its name.
  if (Number(message.fields.param_index) >= 0) return false;
  const code = Number(message.fields.error);
  const reason = enumName('MAV_PARAM_ERROR', code) ?? `error ${code}`;
  throw new StationError('ParameterDenied', `${operation} failed: ${reason}`, [], code);
}

/** Answers with another value than the one that was set, until the vehicle is believed to keep it. */
const MAX_OTHER_VALUES = 2;

/** Sets a parameter and returns the value that the vehicle has then; rejects if it is another one. */
export async function writeParameter(
  channel: Channel,
  name: string,
  value: number,
  encoding: ParameterEncoding,
): Promise<Parameter> {
  const operation = `setting ${name} of ${channel.system}/${channel.component}`;
  const type = Number((await readMessage(channel, name)).fields.param_type);
  const wire = encodeValue(value, type, encoding);
  if (wire === null)
    throw new StationError('InvalidArgumentError', `${name} is of type ${typeName(type)}, which cannot hold ${value}`);
  let others = 0;
  const read = (message: DecodedMessage): Parameter | undefined => {
    if (!isAbout(message, name, operation)) return undefined;
    const parameter = parameterOf(message, encoding);
    if (isSame(parameter.value, value, type, encoding)) return parameter;
    others += 1;
    // The first may be a late answer to the request above, which was repeated.
    if (others < MAX_OTHER_VALUES) return undefined;
    throw new StationError('ParameterDenied', `${operation} failed: the vehicle keeps ${parameter.text}`);
  };
  return request(channel, {
    operation,
    timeoutKind: 'ParameterTimeout',
    answers: ['PARAM_VALUE', 'PARAM_ERROR'],
    send: () => channel.sendMessage('PARAM_SET', { param_id: name, param_value: wire, param_type: type }),
    read,
  });
}

/** Reads all parameters, sorted by name. */
export function readParameters(
  channel: Channel,
  encoding: ParameterEncoding,
  onProgress?: ProgressListener,
): Promise<Parameter[]> {
  return new ParameterList(channel, encoding, onProgress).read();
}

class ParameterList {
  private readonly channel: Channel;
  private readonly encoding: ParameterEncoding;
  private readonly onProgress: ProgressListener | undefined;
  private readonly found = new Map<number, Parameter>();
  private total: number | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private idleRounds = 0;
  private foundBefore = 0;

  constructor(channel: Channel, encoding: ParameterEncoding, onProgress?: ProgressListener) {
    this.channel = channel;
    this.encoding = encoding;
    this.onProgress = onProgress;
  }

  read(): Promise<Parameter[]> {
    return new Promise((resolve, reject) => {
      const remove = this.channel.onMessage('PARAM_VALUE', (message) => {
        if (message.component !== this.channel.component) return;
        this.take(message);
        if (this.found.size === this.total) end(() => resolve(this.sorted()));
        else this.wait(round);
      });
      const end = (finish: () => void): void => {
        clearTimeout(this.timer);
        remove();
        finish();
      };
      const round = (): void => {
        const error = this.requestMissing();
        if (error !== null) end(() => reject(error));
        else this.wait(round);
      };
      round();
    });
  }

  private take(message: DecodedMessage): void {
    this.total = Number(message.fields.param_count);
    const index = Number(message.fields.param_index);
    // Values of other requests have the index 65535.
    if (index < this.total) this.found.set(index, parameterOf(message, this.encoding));
    this.onProgress?.(this.found.size, this.total);
  }

  private wait(round: () => void): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(round, LIST_TIMEOUT);
  }

  /** Requests what is missing; returns the error if the vehicle answers no more. */
  private requestMissing(): StationError | null {
    this.idleRounds = this.found.size > this.foundBefore ? 0 : this.idleRounds + 1;
    this.foundBefore = this.found.size;
    if (this.idleRounds > MAX_ROUNDS_WITHOUT_PROGRESS) {
      const of = this.total === null ? 'no answer' : `${this.found.size} of ${this.total} arrived`;
      const target = `${this.channel.system}/${this.channel.component}`;
      return new StationError('ParameterTimeout', `reading the parameters of ${target} failed: ${of}`);
    }
    if (this.total === null) {
      this.channel.sendMessage('PARAM_REQUEST_LIST', {});
      return null;
    }
    let requested = 0;
    for (let index = 0; index < this.total && requested < MISSING_PER_ROUND; index += 1) {
      if (this.found.has(index)) continue;
      this.channel.sendMessage('PARAM_REQUEST_READ', { param_id: '', param_index: index });
      requested += 1;
    }
    return null;
  }

  private sorted(): Parameter[] {
    return [...this.found.values()].sort((one, other) => (one.name < other.name ? -1 : 1));
  }
}
