/** The times between the values of a stream, by which a missing one is noticed. */

/** How much the newest interval counts. */
const SMOOTHING = 0.2;
/** A value is overdue after so many of its intervals, but not before some seconds. */
const OVERDUE = 4;
const MIN_LIMIT = 3000;
/** The limit of a value that came once. */
const FIRST_LIMIT = 10_000;

export class Pace {
  /** Time of the newest value in ms; null before the first. */
  time: number | null = null;
  /** Smoothed time between values in ms; null before the second. */
  interval: number | null = null;

  take(time: number): void {
    if (this.time !== null && time > this.time) {
      const elapsed = time - this.time;
      this.interval = this.interval === null ? elapsed : this.interval + SMOOTHING * (elapsed - this.interval);
    }
    this.time = time;
  }

  /** Returns the age of the newest value in ms if the next one is overdue; null: it is not. */
  overdue(now: number): number | null {
    if (this.time === null) return null;
    const age = now - this.time;
    const limit = this.interval === null ? FIRST_LIMIT : Math.max(MIN_LIMIT, OVERDUE * this.interval);
    return age > limit ? age : null;
  }

  clear(): void {
    this.time = null;
    this.interval = null;
  }
}
