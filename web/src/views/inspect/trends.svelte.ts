/** The fields whose trends the view shows; they outlive a change of the view. */
import { formatFieldRef, type FieldRef } from '$lib/series/fieldRef';
import { live } from '$lib/series/live.svelte';
import type { Series } from '$lib/series/SeriesHub';

export interface Trend {
  readonly key: string;
  readonly series: Series;
  readonly unit: string;
}

const MAX_TRENDS = 16;

class Trends {
  list: readonly Trend[] = $state.raw([]);
  paused: boolean = $state(false);
  /** Seconds that the plot shows. */
  window: number = $state(30);

  has(ref: FieldRef): boolean {
    const key = formatFieldRef(ref);
    return this.list.some((trend) => trend.key === key);
  }

  /** Adds a field, or removes it if it is shown. */
  toggle(ref: FieldRef, unit: string): void {
    const key = formatFieldRef(ref);
    if (this.has(ref)) {
      this.remove(key);
      return;
    }
    if (this.list.length >= MAX_TRENDS) this.remove(this.list[0]!.key);
    this.list = [...this.list, { key, series: live.hub.watch(ref), unit }];
  }

  remove(key: string): void {
    for (const trend of this.list) if (trend.key === key) live.hub.release(trend.series);
    this.list = this.list.filter((trend) => trend.key !== key);
  }
}

export const trends = new Trends();
