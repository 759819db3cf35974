/** Colours of series: those of Okabe and Ito, which colour-blind people tell apart, legible on dark and light. */
const DARK = ['#56b4e9', '#e69f00', '#2fc79a', '#f0e442', '#cc79a7', '#ff8a4c', '#8fa3ff', '#b8c0cc'] as const;
const LIGHT = ['#0072b2', '#b87a00', '#00805c', '#8f8500', '#b0558a', '#c24e00', '#4a5fd0', '#5b6470'] as const;

/** Returns the colour of the series of a number, repeated after eight. */
export function seriesColour(index: number, dark: boolean): string {
  const colours = dark ? DARK : LIGHT;
  return colours[index % colours.length] ?? colours[0];
}
