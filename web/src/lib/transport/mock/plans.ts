/** The mission protocol of a vehicle of the demo: missions, fences and rally points. */

import { MavAutopilot, MavMissionResult, MavMissionType } from '$generated';
import type { DecodedMessage, SentFields } from '$lib/decoder/Decoder';
import type { PlanItem } from '$lib/vehicle/Vehicle';
import { fieldsOf, itemOf } from '$lib/vehicle/link/plans';

import type { MockAutopilot } from './MockAutopilot';

/** Seconds after which an item is requested again. */
const REQUEST_INTERVAL = 1;

export class MissionServer {
  private readonly autopilot: MockAutopilot;
  private readonly send: (name: string, fields: SentFields) => void;
  private readonly others: Record<number, PlanItem[]> = { [MavMissionType.FENCE]: [], [MavMissionType.RALLY]: [] };
  private upload: { type: number; count: number; items: PlanItem[] } | null = null;
  /** Requests the next item again. */
  private repeat: (() => void) | null = null;
  private silence = 0;

  constructor(autopilot: MockAutopilot, send: (name: string, fields: SentFields) => void) {
    this.autopilot = autopilot;
    this.send = send;
  }

  receive(message: DecodedMessage): void {
    const { fields, system, component } = message;
    const type = Number(fields.mission_type);
    const answer = (name: string, more: SentFields): void =>
      this.send(name, { target_system: system, target_component: component, mission_type: type, ...more });
    if (message.name.startsWith('MISSION_') && this.autopilot.profile.autopilot !== MavAutopilot.ARDUPILOTMEGA) {
      return answer('MISSION_ACK', { type: MavMissionResult.UNSUPPORTED });
    }
    switch (message.name) {
      case 'MISSION_REQUEST_LIST':
        return answer('MISSION_COUNT', { count: this.items(type).length });
      case 'MISSION_REQUEST_INT':
      case 'MISSION_REQUEST':
        return this.give(type, Number(fields.seq), answer);
      case 'MISSION_COUNT':
        this.upload = { type, count: Number(fields.count), items: [] };
        return this.next(answer);
      case 'MISSION_ITEM_INT':
        return this.take(itemOf(message), answer);
      case 'MISSION_CLEAR_ALL':
        this.store(type, []);
        return answer('MISSION_ACK', { type: MavMissionResult.ACCEPTED });
      default:
    }
  }

  /** Repeats a request whose item got lost; `dt` in seconds. */
  step(dt: number): void {
    this.silence += dt;
    if (this.upload === null || this.silence < REQUEST_INTERVAL) return;
    this.silence = 0;
    this.repeat?.();
  }

  private items(type: number): PlanItem[] {
    return type === MavMissionType.MISSION ? this.autopilot.mission : (this.others[type] ?? []);
  }

  private store(type: number, items: PlanItem[]): void {
    if (type !== MavMissionType.MISSION) {
      this.others[type] = items;
      return;
    }
    // Home stays where it is, whatever the upload says.
    const home = this.autopilot.mission[0] ?? items[0];
    this.autopilot.mission = home === undefined ? [] : [home, ...items.slice(1)];
    this.autopilot.start(1);
  }

  private give(type: number, seq: number, answer: (name: string, fields: SentFields) => void): void {
    const item = this.items(type)[seq];
    if (item === undefined) return answer('MISSION_ACK', { type: MavMissionResult.INVALID_SEQUENCE });
    answer('MISSION_ITEM_INT', fieldsOf({ ...item, seq }, type));
  }

  private next(answer: (name: string, fields: SentFields) => void): void {
    if (this.upload === null) return;
    const { items, count, type } = this.upload;
    this.silence = 0;
    this.repeat = () => this.next(answer);
    if (items.length < count) return answer('MISSION_REQUEST_INT', { seq: items.length });
    this.store(type, items);
    this.upload = null;
    answer('MISSION_ACK', { type: MavMissionResult.ACCEPTED });
  }

  private take(item: PlanItem, answer: (name: string, fields: SentFields) => void): void {
    if (this.upload === null) return;
    if (item.seq === this.upload.items.length) this.upload.items.push(item);
    this.next(answer);
  }
}
