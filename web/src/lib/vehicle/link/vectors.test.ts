/** The protocols of the page pass the vectors of `conformance/services.jsonl`, which the clients of Python pass too. */

import { readFileSync } from 'node:fs';

import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { MavParamType } from '$generated';
import { StationError } from '$lib/api/errors';
import { Decoder, type DecodedMessage, Encoder, fieldBytes, messageInfo, type SentFields } from '$lib/decoder/Decoder';

import type { MessageListener, Parameter, PlanItem, PlanKind, StatusText } from '../Vehicle';
import type { Channel } from './channel';
import { type CommandPlace, sendCommand } from './commands';
import { readParameter, readParameters, writeParameter } from './parameters';
import type { ParameterEncoding } from './parameterValue';
import { PlanClient } from './plans';

/** Texts that begin with `0x` are the bytes of a value, null is NaN. */
type Fields = Readonly<Record<string, number | string | null>>;
type Named = readonly [name: string, fields: Fields];

interface Rule {
  readonly when: string;
  readonly fields?: Fields;
  readonly answers: readonly Named[];
  readonly once?: boolean;
  lost?: number;
}

interface VectorItem {
  readonly command: number;
  readonly frame: number;
  readonly params: readonly (number | null)[];
  readonly autocontinue: boolean;
}

interface Call {
  readonly command: number;
  readonly params: readonly (number | null)[];
  readonly place?: { readonly [Key in keyof CommandPlace]: number | null };
  readonly name: string;
  readonly value: number;
  readonly encoding: ParameterEncoding;
  readonly type: number;
  readonly items: readonly VectorItem[];
}

interface Vector {
  readonly name: string;
  readonly service: string;
  readonly call: Call;
  readonly vehicle: readonly Rule[];
  readonly sends: readonly Named[];
  readonly never?: readonly string[];
  readonly result?: unknown;
  readonly error?: { readonly kind: string; readonly code?: number };
}

/** Seconds in which each call has ended. */
const DEADLINE = 120;
const PLAN_KINDS: readonly PlanKind[] = ['mission', 'fence', 'rally'];
const VECTORS = readFileSync(new URL('../../../../../conformance/services.jsonl', import.meta.url), 'utf8')
  .split('\n')
  .filter((line) => line !== '')
  .map((line) => JSON.parse(line) as Vector);

function bytesOf(text: string): Uint8Array {
  return Uint8Array.from(text.slice(2).match(/../g) ?? [], (pair) => parseInt(pair, 16));
}

const isBytes = (value: unknown): value is string => typeof value === 'string' && value.startsWith('0x');

function hasFields(message: DecodedMessage, fields: Fields): boolean {
  return Object.entries(fields).every(([name, value]) => {
    if (isBytes(value)) return fieldBytes(message, name).join() === bytesOf(value).join();
    const found = message.fields[name];
    return value === null ? Number.isNaN(found) : found === value;
  });
}

/** A vehicle that answers by the rules of a vector, at the end of a channel. */
class ScriptedVehicle implements Channel {
  readonly system = 1;
  readonly component = 1;
  readonly sent: DecodedMessage[] = [];
  private readonly rules: Rule[];
  private readonly listeners = new Map<string, Set<MessageListener>>();
  private readonly textListeners = new Set<(text: StatusText) => void>();
  private readonly encoder = new Encoder();
  private readonly decoder = new Decoder();

  constructor(rules: readonly Rule[]) {
    this.rules = rules.map((rule) => ({ ...rule }));
  }

  sendMessage(name: string, fields: SentFields): void {
    const packet = this.encoder.build(name, { target_system: 1, target_component: 1, ...fields });
    for (const message of this.decoder.push(packet)) {
      this.sent.push(message);
      setTimeout(() => this.answer(message), 10);
    }
  }

  onMessage(name: string, listener: MessageListener): () => void {
    const listeners = this.listeners.get(name) ?? new Set();
    this.listeners.set(name, listeners.add(listener));
    return () => listeners.delete(listener);
  }

  onStatusText(listener: (text: StatusText) => void): () => void {
    this.textListeners.add(listener);
    return () => this.textListeners.delete(listener);
  }

  private answer(message: DecodedMessage): void {
    const rule = this.rules.find(({ when, fields = {} }) => when === message.name && hasFields(message, fields));
    if (rule === undefined) return;
    if ((rule.lost ?? 0) > 0) {
      rule.lost = rule.lost! - 1;
      return;
    }
    if (rule.once === true) this.rules.splice(this.rules.indexOf(rule), 1);
    for (const [name, fields] of rule.answers) this.deliver(name, fields);
  }

  private deliver(name: string, { '@component': component, ...fields }: Fields): void {
    const hasTarget = messageInfo(name)!.fields.some((field) => field.name === 'target_system');
    const target = hasTarget ? { target_system: 255, target_component: 190 } : {};
    const values = Object.entries(fields).map(([key, value]) => [
      key,
      isBytes(value) ? bytesOf(value) : (value ?? NaN),
    ]);
    const encoder = new Encoder(this.system, Number(component ?? this.component));
    for (const message of this.decoder.push(encoder.build(name, { ...target, ...Object.fromEntries(values) }))) {
      for (const listener of [...(this.listeners.get(name) ?? [])]) listener(message);
      if (name === 'STATUSTEXT') this.tell(message);
    }
  }

  private tell({ system, component, time, fields }: DecodedMessage): void {
    const text = { system, component, time, severity: Number(fields.severity), text: String(fields.text) };
    for (const listener of this.textListeners) listener(text);
  }
}

const parameterJson = ({ name, value, type }: Parameter): unknown => ({
  name,
  value,
  type: MavParamType[type as keyof typeof MavParamType],
});

const itemJson = ({ command, frame, params, autocontinue }: PlanItem): VectorItem => ({
  command,
  frame,
  params,
  autocontinue,
});

const placeOf = ({ frame, latitude, longitude, altitude }: NonNullable<Call['place']>): CommandPlace => ({
  frame: frame ?? 0,
  latitude: latitude ?? NaN,
  longitude: longitude ?? NaN,
  altitude: altitude ?? NaN,
});

/** Makes the call of a vector; resolves with the result as vectors have it. */
const CALLS: Readonly<Record<string, (channel: Channel, call: Call) => Promise<unknown>>> = {
  async command(channel, { command, params, place }) {
    const { result, detail } = await sendCommand(channel, 'sending', command, params, place && placeOf(place));
    expect(result).toBe('ACCEPTED');
    return { result: 0, detail };
  },
  get: async (channel, { name, encoding }) => parameterJson(await readParameter(channel, name, encoding)),
  set: async (channel, { name, value, encoding }) =>
    parameterJson(await writeParameter(channel, name, value, encoding)),
  list: async (channel, { encoding }) => (await readParameters(channel, encoding)).map(parameterJson),
  download: async (channel, { type }) =>
    (await new PlanClient(channel, false).download(PLAN_KINDS[type]!)).items.map(itemJson),
  async upload(channel, { type, items }) {
    const numbered = items.map((item, seq) => ({ ...item, seq, name: '' }));
    await new PlanClient(channel, false).upload(PLAN_KINDS[type]!, { items: numbered, home: null });
    return null;
  },
  async clear(channel, { type }) {
    await new PlanClient(channel, false).clear(PLAN_KINDS[type]!);
    return null;
  },
};

beforeEach(() => vi.useFakeTimers({ now: 1_790_000_000_000 }));
afterEach(() => vi.useRealTimers());

describe('vectors', () => {
  it.each(VECTORS.map((vector) => [vector.name, vector] as const))('%s', async (_, vector) => {
    const vehicle = new ScriptedVehicle(vector.vehicle);
    let outcome: { readonly result: unknown } | { readonly error: unknown } | null = null;
    const call = async (): Promise<unknown> => CALLS[vector.service]!(vehicle, vector.call);
    void call().then(
      (result) => (outcome = { result }),
      (error: unknown) => (outcome = { error }),
    );
    for (let second = 0; outcome === null && second < DEADLINE; second += 1) await vi.advanceTimersByTimeAsync(1000);
    if (vector.error === undefined) expect(outcome).toEqual({ result: vector.result });
    else expect(outcome).toEqual({ error: expect.objectContaining(vector.error) });
    for (const [name, fields] of vector.sends) {
      const found = vehicle.sent.some((message) => message.name === name && hasFields(message, fields));
      expect([name, fields, found]).toEqual([name, fields, true]);
    }
    for (const name of vector.never ?? []) expect(vehicle.sent.map((message) => message.name)).not.toContain(name);
    if (vector.error !== undefined)
      expect((outcome as unknown as { error: unknown }).error).toBeInstanceOf(StationError);
  });
});
