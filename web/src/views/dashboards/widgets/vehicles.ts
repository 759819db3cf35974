/** Vehicles on the map of a dashboard: pairs of fields, latitude and longitude. */
import type { Track } from '$lib/map/track';
import type { Place } from '$lib/map/geometry';
import { disc, label, polyline, type Drawing } from '$lib/map/drawing';
import { seriesColour } from '$lib/plot/colours';

import { valueOf, type Watched } from './reading.svelte';

export interface MappedVehicle {
  readonly name: string;
  readonly place: Place | null;
}

/** Returns a vehicle for each pair of fields; its place is null while it is unknown or no place of the earth. */
export function vehiclesOf(watched: readonly Watched[]): MappedVehicle[] {
  const vehicles: MappedVehicle[] = [];
  for (let index = 0; index + 1 < watched.length; index += 2) {
    const [latitude, longitude] = [valueOf(watched[index]!), valueOf(watched[index + 1]!)];
    const known = latitude !== null && longitude !== null && Math.abs(latitude) <= 90 && Math.abs(longitude) <= 180;
    // Vehicles without a fix tell 0, 0.
    const place = known && (latitude !== 0 || longitude !== 0) ? { latitude, longitude } : null;
    vehicles.push({ name: watched[index]!.label, place });
  }
  return vehicles;
}

export function paintVehicles(drawing: Drawing, vehicles: readonly MappedVehicle[], tracks: readonly Track[]): void {
  const { projection, palette } = drawing;
  vehicles.forEach(({ name, place }, index) => {
    if (place === null) return;
    const colour = seriesColour(index, palette.isDark);
    const pixel = projection.toPixel(place.latitude, place.longitude);
    const places = tracks[index]?.places ?? [];
    const line = places.map(({ latitude, longitude }) => projection.toPixel(latitude, longitude));
    polyline(drawing, [...line, pixel], { colour, width: 2.2, hasHalo: true });
    disc(drawing, pixel, 7, { fill: colour, outline: palette.halo });
    label(drawing, name, { x: pixel.x, y: pixel.y + 18 });
  });
}
