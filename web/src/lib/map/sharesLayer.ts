/** The parts of several vehicles on the map, in their colours. */

import { polyline, type Drawing } from './drawing';
import { vehicleColour } from './palette';
import { pageTheme } from './theme.svelte';

/** Paints the legs of each part. */
export function paintShares(
  drawing: Drawing,
  shares: readonly {
    readonly system: number | null;
    readonly legs: readonly (readonly (readonly [number, number])[])[];
  }[],
): void {
  for (const { system, legs } of shares) {
    const colour = vehicleColour(system ?? 1, pageTheme.isDark);
    const pixels = legs.flat().map(([latitude, longitude]) => drawing.projection.toPixel(latitude, longitude));
    polyline(drawing, pixels, { colour, width: 2, hasHalo: true });
  }
}
