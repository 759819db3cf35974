/**
 * The series that plots and widgets watch: fed with every message, kept only where they are watched.
 *
 * A series holds its newest value until the next update ("latched"). Messages and sources that are not watched
 * cost one look-up; unknown ones are ignored.
 */
import { Ring } from '../plot/Ring';
import { Pace } from './Pace';
import { type FieldRef, type Sample, formatFieldRef, matchesSource, numberOf } from './fieldRef';

export const DEFAULT_CAPACITY = 6000;

export class Series {
  readonly ref: FieldRef;
  readonly ring: Ring;
  /** The newest value as it came, for texts; null before the first. */
  latest: unknown = null;
  users = 0;
  private readonly pace = new Pace();

  constructor(ref: FieldRef, capacity: number) {
    this.ref = ref;
    this.ring = new Ring(capacity);
  }

  /** Time of the newest value in ms; null before the first. */
  get time(): number | null {
    return this.pace.time;
  }

  /** Smoothed time between values in ms; null before the second. */
  get interval(): number | null {
    return this.pace.interval;
  }

  get value(): number | null {
    return this.ring.lastValue;
  }

  /** Takes a value; one that is neither a number nor a text, such as NaN, is none: the one before gets old. */
  take(time: number, value: unknown): void {
    const number = numberOf(value, this.ref.index);
    if (number === null && typeof value !== 'string') return;
    this.pace.take(time);
    this.latest = value;
    if (number !== null) this.ring.push(time, number);
  }

  /** Returns the age of the value in ms if the next one is overdue by the rate of this field; null: it is not. */
  overdue(now: number): number | null {
    return this.pace.overdue(now);
  }

  clear(): void {
    this.ring.clear();
    this.latest = null;
    this.pace.clear();
  }
}

export class SeriesHub {
  private readonly series = new Map<string, Series>();
  private readonly byMessage = new Map<string, Series[]>();
  private readonly capacity: number;

  constructor(capacity = DEFAULT_CAPACITY) {
    this.capacity = capacity;
  }

  /** Returns the series of a reference, shared by all that watch it; each calls `release` at its end. */
  watch(ref: FieldRef): Series {
    const key = formatFieldRef(ref);
    let series = this.series.get(key);
    if (series === undefined) {
      series = new Series(ref, this.capacity);
      this.series.set(key, series);
      this.byMessage.set(ref.message, [...(this.byMessage.get(ref.message) ?? []), series]);
    }
    series.users++;
    return series;
  }

  release(series: Series): void {
    if (--series.users > 0) return;
    this.series.delete(formatFieldRef(series.ref));
    const others = (this.byMessage.get(series.ref.message) ?? []).filter((each) => each !== series);
    if (others.length > 0) this.byMessage.set(series.ref.message, others);
    else this.byMessage.delete(series.ref.message);
  }

  get size(): number {
    return this.series.size;
  }

  /** Returns whether a message is watched, so that its fields need not be read otherwise. */
  wants(message: string): boolean {
    return this.byMessage.has(message);
  }

  feed(sample: Sample): void {
    const listening = this.byMessage.get(sample.message);
    if (listening === undefined) return;
    for (const series of listening) {
      const { ref } = series;
      if (!Object.hasOwn(sample.fields, ref.field) || !matchesSource(ref.source, sample.source)) continue;
      series.take(sample.time, sample.fields[ref.field]);
    }
  }

  /** Drops all values, for a replay that jumps. */
  clear(): void {
    for (const series of this.series.values()) series.clear();
  }
}
