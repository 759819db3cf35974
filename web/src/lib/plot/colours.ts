/**
 * Colours of series and of vehicles, which colour-blind people tell apart, legible on dark and light.
 *
 * The first ones are those of Okabe and Ito; `colours.test.ts` measures all as people without one kind of cone see
 * them.
 */
export const DARK = ['#56b4e9', '#e69f00', '#009e73', '#f0e442', '#cc79a7', '#8769ff', '#c3f0b4', '#96873c'] as const;
export const LIGHT = ['#0072b2', '#d55e00', '#009e73', '#960069', '#5a4b0f', '#8769f0', '#f0004b', '#9600ff'] as const;

/** Returns the colour of the series of a number, repeated after eight. */
export function seriesColour(index: number, dark: boolean): string {
  const colours = dark ? DARK : LIGHT;
  return colours[index % colours.length] ?? colours[0];
}
