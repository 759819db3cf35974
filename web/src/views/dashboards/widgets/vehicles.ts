/** Vehicles on the map of a dashboard: pairs of fields, latitude and longitude. */
import type { Track } from '$lib/map/track';
import type { Place } from '$lib/map/geometry';
import { disc, label, polyline, type Drawing } from '$lib/map/drawing';
import { paintSymbolAt } from '$lib/map/vehicleLayer';
import { seriesColour } from '$lib/plot/colours';
import { fleet } from '$lib/store/fleet.svelte';
import type { VehicleState, VehicleType } from '$lib/vehicle/Vehicle';

import { readingOf, type Watched } from './reading.svelte';

export interface MappedVehicle {
  readonly name: string;
  readonly place: Place | null;
  /** The kind of the MAVLink vehicle that the place is of; `unknown` for other sources. */
  readonly type: VehicleType;
  /** In degrees; null: not known. */
  readonly heading: number | null;
}

/** Returns the state of the MAVLink vehicle of a source such as `1/1` or `*`, null for other sources. */
export function stateOfSource(source: string): VehicleState | null {
  if (source === '*') return fleet.selected?.state ?? null;
  const system = /^(\d+)(?:\/\d+)?$/.exec(source)?.[1];
  return system === undefined ? null : (fleet.vehicle(Number(system))?.state ?? null);
}

/** Returns a vehicle for each pair of fields; its place is null while it is unknown or no place of the earth. */
export function vehiclesOf(watched: readonly Watched[]): MappedVehicle[] {
  const vehicles: MappedVehicle[] = [];
  for (let index = 0; index + 1 < watched.length; index += 2) {
    const [latitude, longitude] = [readingOf(watched[index]!), readingOf(watched[index + 1]!)];
    const known = latitude !== null && longitude !== null && Math.abs(latitude) <= 90 && Math.abs(longitude) <= 180;
    // Vehicles without a fix tell 0, 0.
    const place = known && (latitude !== 0 || longitude !== 0) ? { latitude, longitude } : null;
    const state = stateOfSource(watched[index]!.field.ref.source);
    vehicles.push({
      name: watched[index]!.label,
      place,
      type: state?.type ?? 'unknown',
      heading: state?.heading ?? null,
    });
  }
  return vehicles;
}

export function paintVehicles(drawing: Drawing, vehicles: readonly MappedVehicle[], tracks: readonly Track[]): void {
  const { projection, palette } = drawing;
  vehicles.forEach(({ name, place, type, heading }, index) => {
    if (place === null) return;
    const colour = seriesColour(index, palette.isDark);
    const pixel = projection.toPixel(place.latitude, place.longitude);
    const places = tracks[index]?.places ?? [];
    const line = places.map(({ latitude, longitude }) => projection.toPixel(latitude, longitude));
    polyline(drawing, [...line, pixel], { colour, width: 2.2, hasHalo: true });
    if (type === 'unknown') disc(drawing, pixel, 7, { fill: colour, outline: palette.halo });
    else paintSymbolAt(drawing, pixel, { type, heading, colour, isArmed: true });
    label(drawing, name, { x: pixel.x, y: pixel.y + (type === 'unknown' ? 18 : 27) });
  });
}
