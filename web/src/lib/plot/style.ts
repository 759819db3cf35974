/** How plots look: colours of the theme, and short texts at their axes. */
import type uPlot from 'uplot';

/** Returns the style of an axis in the colours that hold for an element. */
export function axisStyle(element: HTMLElement): Partial<uPlot.Axis> {
  const style = getComputedStyle(element);
  const colour = (name: string): string => style.getPropertyValue(name).trim();
  const line = { stroke: colour('--border'), width: 1 };
  return {
    stroke: colour('--text-3'),
    grid: line,
    ticks: { ...line, size: 4 },
    font: `11px ${style.fontFamily}`,
    gap: 4,
  };
}

/** Returns the time of day of seconds since 1970, such as `14:03:27`. */
export function clock(seconds: number): string {
  const date = new Date(seconds * 1000);
  const parts = [date.getHours(), date.getMinutes(), date.getSeconds()];
  const text = parts.map((part) => String(part).padStart(2, '0')).join(':');
  const rest = Math.round((seconds - Math.floor(seconds)) * 1000);
  return rest === 0 || rest === 1000 ? text : `${text}.${String(rest).padStart(3, '0').replace(/0+$/, '')}`;
}

/** Half the width of a character of the labels in pixels, generously. */
const HALF_CHARACTER = 3.5;

/** Returns labels at places of a picture, in pixels from its left edge; one that an edge would cut is empty. */
export function uncutLabels(labels: readonly string[], places: readonly number[], width: number): string[] {
  return labels.map((label, index) => {
    const half = label.length * HALF_CHARACTER;
    return places[index]! >= half && places[index]! <= width - half ? label : '';
  });
}

/** Returns the labels of the horizontal axis of a plot, as far as they are not cut. */
export function horizontalLabels(plot: uPlot, splits: readonly number[], text: (value: number) => string): string[] {
  const left = plot.bbox.left / devicePixelRatio;
  return uncutLabels(
    splits.map(text),
    splits.map((split) => left + plot.valToPos(split, 'x')),
    plot.width,
  );
}

/** Returns a number with as many digits as an axis has place for. */
export function shortNumber(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(1);
  return String(Number(value.toPrecision(8)));
}

/** Returns a value for people: a fixed number of digits that fits its size. */
export function readableNumber(value: number | null, decimals?: number): string {
  if (value === null || !Number.isFinite(value)) return '–';
  if (decimals !== undefined) return value.toFixed(decimals);
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e7 || (size < 1e-4 && size > 0)) return value.toExponential(3);
  return value.toFixed(Math.max(0, Math.min(6, 4 - Math.floor(Math.log10(size)))));
}
