/** The last reports of the systems of the selected vehicle, and how old they are. */

import { MavCmd } from '$generated';
import type { DecodedMessage } from '$lib/decoder/Decoder';
import { Pace } from '$lib/series/Pace';
import { fleet } from '$lib/store/fleet.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { ANSWERS, type Kind, KINDS } from './reports';

/** Time in ms between two pictures. */
const INTERVAL = 500;
/** A vehicle with more devices than this shows the first ones. */
const MAX_REPORTS = 48;
/** Weight of the newest second in the rate of a stream. */
const SMOOTHING = 0.5;
const SEQUENCES = 0x10000;
/** A larger gap is a new beginning of the stream. */
const MAX_GAP = 1000;

/** A report as it is shown. */
export interface Shown {
  readonly key: string;
  readonly kind: Kind;
  /** Number of the device if a vehicle has several; null: there is one. */
  readonly instance: number | null;
  readonly fields: DecodedMessage['fields'];
  readonly rate: number;
  readonly lost: number;
  /** Age in ms if the next report is overdue; null: it is not. An answer is never overdue. */
  readonly overdue: number | null;
}

/** One stream of reports. */
export class Report {
  readonly kind: Kind;
  private readonly pace = new Pace();
  private readonly isAnswer: boolean;
  private last: DecodedMessage;
  private count = 0;
  private countedAt: number;
  private rate = 0;
  private lost = 0;

  constructor(kind: Kind, first: DecodedMessage, isAnswer: boolean) {
    this.kind = kind;
    this.last = first;
    this.isAnswer = isAnswer;
    this.countedAt = first.time;
  }

  take(message: DecodedMessage): void {
    const [now, before] = [message.fields.sequence, this.last.fields.sequence];
    if (now !== undefined && before !== undefined && message !== this.last) {
      const missing = (Number(now) - Number(before) - 1 + SEQUENCES) % SEQUENCES;
      if (missing < MAX_GAP) this.lost += missing;
    }
    this.last = message;
    this.count += 1;
    this.pace.take(message.time);
  }

  /** Returns what is shown at a time in ms since 1970. */
  show(key: string, now: number): Shown {
    const elapsed = now - this.countedAt;
    if (elapsed >= INTERVAL) {
      const measured = (this.count * 1000) / elapsed;
      this.rate = this.rate === 0 ? measured : this.rate + SMOOTHING * (measured - this.rate);
      [this.count, this.countedAt] = [0, now];
    }
    const { kind, rate, lost } = this;
    const { fields } = this.last;
    const instance = kind.instance === '' ? null : Number(fields[kind.instance] ?? 0);
    return { key, kind, instance, fields, rate, lost, overdue: this.isAnswer ? null : this.pace.overdue(now) };
  }
}

class Systems {
  reports: readonly Shown[] = $state.raw([]);
  readonly isPresent = $derived(this.reports.length > 0);
  /** Number of reports that are overdue. */
  readonly overdue = $derived(this.reports.filter(({ overdue }) => overdue !== null).length);

  /** Shows the reports of a vehicle from now on; returns the function that ends it. */
  follow(vehicle: Vehicle | null): () => void {
    this.reports = [];
    if (vehicle === null) return () => undefined;
    const found = new Map<string, Report>();
    const keep = (kind: Kind, key: string, message: DecodedMessage, isAnswer = false): void => {
      let report = found.get(key);
      if (report === undefined) {
        if (found.size >= MAX_REPORTS) return;
        found.set(key, (report = new Report(kind, message, isAnswer)));
      }
      report.take(message);
    };
    const removers = Object.entries(KINDS).map(([name, kind]) =>
      vehicle.onMessage(name, (message) => {
        const device = kind.instance === '' ? '' : `/${Number(message.fields[kind.instance] ?? 0)}`;
        keep(kind, `${name}/${message.component}${device}`, message);
      }),
    );
    removers.push(
      fleet.onMessage('COMMAND_ACK', (message) => {
        const command = Number(message.fields.command);
        const kind = ANSWERS[command];
        const isAsked = command === MavCmd.ARM_AUTHORIZATION_REQUEST;
        // The vehicle answers a failure, and another system answers the vehicle that asks whether it may arm.
        const system = isAsked ? Number(message.fields.target_system) : message.system;
        if (kind !== undefined && system === vehicle.system) keep(kind, `ack/${command}`, message, true);
      }),
    );
    const timer = setInterval(() => {
      const now = fleet.now();
      if (found.size > 0) this.reports = [...found].map(([key, report]) => report.show(key, now));
    }, INTERVAL);
    return () => {
      clearInterval(timer);
      for (const remove of removers) remove();
    };
  }
}

export const systems = new Systems();
