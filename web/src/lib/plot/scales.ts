/**
 * Vertical scales of a plot: lines with the same unit share one, so that small values stay visible beside large ones.
 */

/** Scales beyond these are drawn without an axis; there is a left and a right one. */
const MAX_AXES = 2;

export interface PlotScales {
  /** Scale of each line. */
  readonly ofLines: readonly string[];
  /** All scales with their units; the first ones have an axis. */
  readonly all: readonly { readonly key: string; readonly unit: string; readonly hasAxis: boolean }[];
}

export function scalesOf(lines: readonly { readonly unit?: string | undefined }[]): PlotScales {
  const units = [...new Set(lines.map(({ unit }) => unit ?? ''))];
  const keyOf = (unit: string): string => `y${units.indexOf(unit)}`;
  return {
    ofLines: lines.map(({ unit }) => keyOf(unit ?? '')),
    all: units.map((unit, index) => ({ key: keyOf(unit), unit, hasAxis: index < MAX_AXES })),
  };
}
