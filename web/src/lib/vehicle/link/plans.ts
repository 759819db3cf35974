/**
 * The mission protocol: download, upload and clearing of missions, fences and rally points.
 *
 * ArduPilot stores home as item 0 of its mission. It is left out of plans, whose items count from 0.
 */

import { MavCmd, MavFrame, MavMissionResult, MavMissionType } from '$generated';
import { StationError } from '$lib/api/errors';
import { enumName, type DecodedMessage } from '$lib/decoder/Decoder';

import type { Plan, PlanItem, PlanKind, ProgressListener } from '../Vehicle';
import { DEFAULT_ATTEMPTS, request, type Channel } from './channel';
import { fromInteger, scaleOf, toInteger } from './coordinates';

const TYPES: Readonly<Record<PlanKind, number>> = {
  mission: MavMissionType.MISSION,
  fence: MavMissionType.FENCE,
  rally: MavMissionType.RALLY,
};
const UPLOAD_TIMEOUT = 5000;
const FIRST_REQUEST_TIMEOUT = 1500;

/** Returns the item in a MISSION_ITEM_INT, or in a MISSION_ITEM, which has floats. */
export function itemOf(message: DecodedMessage): PlanItem {
  const { fields } = message;
  const frame = Number(fields.frame);
  const command = Number(fields.command);
  const scale = scaleOf(command, frame);
  const isInt = message.name === 'MISSION_ITEM_INT';
  const place = [fields.x, fields.y].map((value) => (isInt ? fromInteger(Number(value), scale) : Number(value)));
  const numbers = [fields.param1, fields.param2, fields.param3, fields.param4].map(Number);
  return {
    seq: Number(fields.seq),
    command,
    name: enumName('MAV_CMD', command) ?? String(command),
    frame,
    params: [...numbers, ...place, Number(fields.z)].map((value) => (Number.isNaN(value) ? null : value)),
    autocontinue: Number(fields.autocontinue) !== 0,
  };
}

/** Returns the fields of MISSION_ITEM_INT for an item. */
export function fieldsOf(item: PlanItem, type: number): Record<string, number> {
  const scale = scaleOf(item.command, item.frame);
  const [param1, param2, param3, param4, x, y, z] = Array.from({ length: 7 }, (_, index) => item.params[index] ?? null);
  return {
    seq: item.seq,
    frame: item.frame,
    command: item.command,
    autocontinue: item.autocontinue ? 1 : 0,
    param1: param1 ?? NaN,
    param2: param2 ?? NaN,
    param3: param3 ?? NaN,
    param4: param4 ?? NaN,
    x: toInteger(x!, scale),
    y: toInteger(y!, scale),
    z: z ?? NaN,
    mission_type: type,
  };
}

/** Moves sequence numbers, those of jumps included. */
function shifted(item: PlanItem, by: number): PlanItem {
  const params = item.command === MavCmd.DO_JUMP ? [(item.params[0] ?? 0) + by, ...item.params.slice(1)] : item.params;
  return { ...item, seq: item.seq + by, params };
}

export class PlanClient {
  private readonly channel: Channel;
  private readonly hasHomeItem: boolean;

  constructor(channel: Channel, hasHomeItem: boolean) {
    this.channel = channel;
    this.hasHomeItem = hasHomeItem;
  }

  async download(kind: PlanKind, onProgress?: ProgressListener): Promise<Plan> {
    const operation = this.operation('downloading', kind);
    const type = TYPES[kind];
    const total = await this.ask(
      operation,
      type,
      ['MISSION_COUNT'],
      () => this.send('MISSION_REQUEST_LIST', type),
      (message) => Number(message.fields.count),
    );
    const items: PlanItem[] = [];
    for (let seq = 0; seq < total; seq += 1) {
      onProgress?.(seq, total);
      const send = (): void => this.send('MISSION_REQUEST_INT', type, { seq });
      const read = (message: DecodedMessage): PlanItem | undefined =>
        Number(message.fields.seq) === seq ? itemOf(message) : undefined;
      items.push(await this.ask(operation, type, ['MISSION_ITEM_INT', 'MISSION_ITEM'], send, read));
    }
    this.send('MISSION_ACK', type, { type: MavMissionResult.ACCEPTED });
    onProgress?.(total, total);
    return kind === 'mission' && this.hasHomeItem ? withoutHome(items) : { items, home: null };
  }

  upload(kind: PlanKind, plan: Plan, onProgress?: ProgressListener): Promise<void> {
    const items = kind === 'mission' && this.hasHomeItem ? withHome(plan) : plan.items;
    const numbered = items.map((item, seq) => ({ ...item, seq }));
    return new Upload(this.channel, this.operation('uploading', kind), TYPES[kind], numbered, onProgress).run();
  }

  async clear(kind: PlanKind): Promise<void> {
    const type = TYPES[kind];
    const operation = this.operation('clearing', kind);
    await this.ask(
      operation,
      type,
      ['MISSION_ACK'],
      () => this.send('MISSION_CLEAR_ALL', type),
      () => true,
    );
  }

  private operation(verb: string, kind: PlanKind): string {
    return `${verb} the ${kind} of ${this.channel.system}/${this.channel.component}`;
  }

  private send(name: string, type: number, fields: Record<string, number> = {}): void {
    this.channel.sendMessage(name, { ...fields, mission_type: type });
  }

  /** Sends a request of the protocol; a MISSION_ACK with an error is a refusal. */
  private ask<Answer>(
    operation: string,
    type: number,
    answers: string[],
    send: () => void,
    read: (message: DecodedMessage) => Answer | undefined,
  ): Promise<Answer> {
    return request(this.channel, {
      operation,
      timeoutKind: 'MissionTimeout',
      answers: [...new Set([...answers, 'MISSION_ACK'])],
      send,
      read: (message) => {
        if (Number(message.fields.mission_type) !== type) return undefined;
        if (message.name === 'MISSION_ACK') refuseUnlessAccepted(operation, message);
        return answers.includes(message.name) ? read(message) : undefined;
      },
    });
  }
}

function refuseUnlessAccepted(operation: string, message: DecodedMessage): void {
  const result = Number(message.fields.type);
  if (result === MavMissionResult.ACCEPTED) return;
  const name = enumName('MAV_MISSION_RESULT', result) ?? String(result);
  throw new StationError('MissionDenied', `${operation} failed: ${name}`, [], result);
}

function withoutHome(items: readonly PlanItem[]): Plan {
  const [first, ...rest] = items;
  const [latitude, longitude, altitude] = first?.params.slice(4) ?? [];
  const hasHome = latitude != null && longitude != null && (latitude !== 0 || longitude !== 0);
  const home = hasHome ? { latitude, longitude, altitude: altitude ?? 0 } : null;
  return { items: rest.map((item) => shifted(item, -1)), home };
}

function withHome(plan: Plan): PlanItem[] {
  const { latitude = 0, longitude = 0, altitude = 0 } = plan.home ?? {};
  const params = [0, 0, 0, 0, latitude, longitude, altitude];
  const home = {
    seq: 0,
    command: MavCmd.NAV_WAYPOINT,
    name: 'NAV_WAYPOINT',
    frame: MavFrame.GLOBAL,
    params,
    autocontinue: true,
  };
  return [home, ...plan.items.map((item) => shifted(item, 1))];
}

/** An upload: the vehicle requests the items that it wants, and acknowledges at the end. */
class Upload {
  private timer: ReturnType<typeof setTimeout> | undefined;
  private attempts = 0;
  private readonly channel: Channel;
  private readonly operation: string;
  private readonly type: number;
  private readonly items: readonly PlanItem[];
  private readonly onProgress: ProgressListener | undefined;

  constructor(
    channel: Channel,
    operation: string,
    type: number,
    items: readonly PlanItem[],
    onProgress?: ProgressListener,
  ) {
    this.channel = channel;
    this.operation = operation;
    this.type = type;
    this.items = items;
    this.onProgress = onProgress;
  }

  run(): Promise<void> {
    return new Promise((resolve, reject) => {
      const removes: (() => void)[] = [];
      const end = (finish: () => void): void => {
        clearTimeout(this.timer);
        for (const remove of removes) remove();
        finish();
      };
      const give = (message: DecodedMessage): void => this.give(message, fail);
      const fail = (): void =>
        end(() =>
          reject(new StationError('MissionTimeout', `${this.operation} failed: the vehicle stopped requesting items`)),
        );
      removes.push(
        this.channel.onMessage('MISSION_REQUEST_INT', give),
        this.channel.onMessage('MISSION_REQUEST', give),
        this.channel.onMessage('MISSION_ACK', (message) => {
          if (Number(message.fields.mission_type) !== this.type) return;
          try {
            refuseUnlessAccepted(this.operation, message);
            end(resolve);
          } catch (error) {
            end(() => reject(error as Error));
          }
        }),
      );
      this.announce(fail);
    });
  }

  private announce(fail: () => void): void {
    if (this.attempts >= DEFAULT_ATTEMPTS) return fail();
    this.attempts += 1;
    this.channel.sendMessage('MISSION_COUNT', { count: this.items.length, mission_type: this.type });
    this.timer = setTimeout(() => this.announce(fail), FIRST_REQUEST_TIMEOUT);
  }

  private give(message: DecodedMessage, fail: () => void): void {
    const item = this.items[Number(message.fields.seq)];
    if (Number(message.fields.mission_type) !== this.type || item === undefined) return;
    clearTimeout(this.timer);
    // A vehicle repeats requests; silence means that the upload or its acknowledgement got lost.
    this.timer = setTimeout(() => this.announce(fail), UPLOAD_TIMEOUT);
    this.channel.sendMessage('MISSION_ITEM_INT', fieldsOf(item, this.type));
    this.onProgress?.(item.seq + 1, this.items.length);
  }
}
