/** The series of a widget's fields, with the values that the widget shows. */
import { fieldLabel } from '$lib/series/fieldRef';
import { live } from '$lib/series/live.svelte';
import type { Series } from '$lib/series/SeriesHub';

import type { WidgetField } from '../model';

export interface Watched {
  readonly field: WidgetField;
  readonly series: Series;
  readonly label: string;
}

/** Returns the number that a field shows, null before its first value. */
export function readingOf({ field, series }: Watched): number | null {
  const { value } = series;
  return value === null ? null : value * field.factor + field.offset;
}

/** Returns a number with so many decimals; one that rounds to zero has no sign. */
export function numberText(value: number, decimals: number): string {
  const text = value.toFixed(decimals);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

/** Returns what a field shows as text: a text of the source as it is. */
export function textOfField(watched: Watched, decimals: number): string {
  const { latest } = watched.series;
  if (typeof latest === 'string') return latest;
  const value = readingOf(watched);
  return value === null ? '–' : numberText(value, decimals);
}

/** Returns the seconds since the oldest of some values, if one of them is overdue by its own rate; null: none is. */
export function overdueOf(watched: readonly Watched[], now: number): number | null {
  const ages = watched.map(({ series }) => series.overdue(now)).filter((age) => age !== null);
  return ages.length === 0 ? null : Math.round(Math.max(...ages) / 1000);
}

/** Watches fields while a component is shown; call it while the component is made. */
export function watchFields(fields: () => readonly WidgetField[]): { readonly list: readonly Watched[] } {
  let list = $state.raw<readonly Watched[]>([]);
  $effect(() => {
    const made = fields().map((field) => ({
      field,
      series: live.hub.watch(field.ref),
      label: field.label || fieldLabel(field.ref),
    }));
    list = made;
    return () => made.forEach(({ series }) => live.hub.release(series));
  });
  return {
    get list() {
      return list;
    },
  };
}
