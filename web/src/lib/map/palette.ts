/** Colours of the map. They come from the theme where it defines them; vehicles have those of series. */

import { seriesColour } from '$lib/plot/colours';

export interface MapPalette {
  readonly isDark: boolean;
  readonly background: string;
  readonly grid: string;
  readonly text: string;
  readonly halo: string;
  readonly accent: string;
  readonly mission: string;
  readonly fenceIn: string;
  readonly fenceOut: string;
  readonly rally: string;
  readonly home: string;
  readonly traffic: string;
  readonly warning: string;
}

export const DARK: MapPalette = {
  isDark: true,
  background: '#121a24',
  grid: 'rgba(150, 178, 208, 0.17)',
  text: '#e8eef6',
  halo: 'rgba(8, 12, 18, 0.88)',
  accent: '#56b4e9',
  mission: '#f0c93c',
  fenceIn: '#20b48c',
  fenceOut: '#e8743b',
  rally: '#cc79a7',
  home: '#ffffff',
  traffic: '#9fd3f5',
  warning: '#e69f00',
};

export const LIGHT: MapPalette = {
  isDark: false,
  background: '#eef1f4',
  grid: 'rgba(40, 62, 90, 0.17)',
  text: '#111a26',
  halo: 'rgba(255, 255, 255, 0.92)',
  accent: '#0072b2',
  mission: '#8a6100',
  fenceIn: '#007d5b',
  fenceOut: '#b0003a',
  rally: '#a3407c',
  home: '#111a26',
  traffic: '#0b5f94',
  warning: '#a86b00',
};

/** Return the colour of a vehicle; eight vehicles in a row differ, each also has its number beside its symbol. */
export function vehicleColour(system: number, isDark: boolean): string {
  return seriesColour(system + 255, isDark);
}
