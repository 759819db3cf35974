/**
 * A bounded series of values over time: the newest replace the oldest.
 *
 * Times are milliseconds since 1970 and never decrease: a value that is older than its predecessor gets the
 * predecessor's time, so that a plot never runs backwards.
 */
export class Ring {
  readonly capacity: number;
  private readonly times: Float64Array;
  private readonly values: Float64Array;
  private start = 0;
  private count = 0;
  /** Values ever pushed: tells a plot whether there is something new. */
  pushed = 0;

  constructor(capacity: number) {
    if (!Number.isInteger(capacity) || capacity < 1) {
      throw new RangeError(`capacity must be a positive integer, got ${capacity}`);
    }
    this.capacity = capacity;
    this.times = new Float64Array(capacity);
    this.values = new Float64Array(capacity);
  }

  get length(): number {
    return this.count;
  }

  push(time: number, value: number): void {
    const previous = this.count > 0 ? this.timeAt(this.count - 1) : -Infinity;
    const place = (this.start + this.count) % this.capacity;
    this.times[place] = Math.max(time, previous);
    this.values[place] = value;
    if (this.count < this.capacity) this.count++;
    else this.start = (this.start + 1) % this.capacity;
    this.pushed++;
  }

  /** Returns the time of a value; index 0 is the oldest. */
  timeAt(index: number): number {
    return this.times[(this.start + index) % this.capacity] ?? NaN;
  }

  valueAt(index: number): number {
    return this.values[(this.start + index) % this.capacity] ?? NaN;
  }

  get lastTime(): number | null {
    return this.count === 0 ? null : this.timeAt(this.count - 1);
  }

  get lastValue(): number | null {
    return this.count === 0 ? null : this.valueAt(this.count - 1);
  }

  clear(): void {
    this.start = 0;
    this.count = 0;
    this.pushed++;
  }

  /** Returns the index of the first value at or after a time, `length` if there is none. */
  indexAt(time: number): number {
    let low = 0;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.timeAt(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Returns a copy of this series that no longer grows, for a plot that is paused. */
  copy(): Ring {
    const copied = new Ring(this.capacity);
    for (let index = 0; index < this.count; index++) copied.push(this.timeAt(index), this.valueAt(index));
    return copied;
  }
}
