/** The maps that the station serves: archives of pictures, vectors or heights, which need no network. */

import { api } from '$lib/api/client';
import { StationError } from '$lib/api/errors';
import type { Models } from '$lib/api/requests';

import { type ArchiveInfo, STATION_MAP } from './base';

export type StationMap = Models['MapInfo'];
export type MapEstimate = Models['MapEstimate'];
export type MapDownloaded = Models['MapDownloaded'];

/** Returns the address of the tiles of a map, with {z}, {x} and {y}. */
export function tilesOf(name: string): string {
  const address = api.url(`maps/${encodeURIComponent(name)}`);
  // A URL object would escape the braces.
  return `${typeof location === 'undefined' ? address : new URL(address, location.href).href}/{z}/{x}/{y}`;
}

/** Returns what the base map needs of a map. */
export function archiveOf(map: StationMap): ArchiveInfo {
  const area = map.area as { south: number; west: number; north: number; east: number } | null;
  // MapLibre has no bounds across the antimeridian: the whole row of tiles is asked for.
  const bounds =
    area !== null && area.west < area.east ? ([area.west, area.south, area.east, area.north] as const) : null;
  return {
    isVector: map.format === 'pbf',
    minZoom: map.min_zoom,
    maxZoom: map.max_zoom,
    layers: map.layers,
    tiles: tilesOf(map.name),
    ...(bounds ? { bounds } : {}),
  };
}

class StationMaps {
  /** The maps, by name; empty until they were loaded. */
  all: readonly StationMap[] = $state.raw([]);
  /** Pictures and vectors. */
  readonly pictures: readonly StationMap[] = $derived(this.all.filter((map) => map.encoding === ''));
  /** Heights of the terrain. */
  readonly heights: readonly StationMap[] = $derived(this.all.filter((map) => map.encoding !== '' && map.tiles > 0));

  /** Loads the list; a page without a station has none. */
  async load(): Promise<void> {
    this.all = await api.get<StationMap[]>('maps');
  }

  /** Returns a map by its name. */
  async find(name: string): Promise<StationMap> {
    await this.load();
    const found = this.all.find((map) => map.name === name);
    if (!found) throw new StationError('NotFound', `the station has no map ${name}`);
    return found;
  }
}

export const stationMaps = new StationMaps();

/** Returns the address of a map of the station for the settings. */
export const addressOf = (map: StationMap): string => STATION_MAP + map.name;

const RADIANS = Math.PI / 180;
const MAX_LATITUDE = 85.051129;

export interface MapArea {
  readonly south: number;
  readonly west: number;
  readonly north: number;
  readonly east: number;
}

/** Returns the number of tiles of an area, as the station counts them. */
export function countTiles(area: MapArea, minZoom: number, maxZoom: number): number {
  let count = 0;
  for (let zoom = minZoom; zoom <= maxZoom; zoom += 1) {
    const [left, top] = tileAt(area.north, area.west, zoom);
    const [right, bottom] = tileAt(area.south, area.east, zoom);
    const edge = 2 ** zoom;
    const isAcross = area.west >= area.east;
    const columns = !isAcross ? right - left + 1 : right >= left ? edge : edge - left + right + 1;
    count += columns * (bottom - top + 1);
  }
  return count;
}

function tileAt(latitude: number, longitude: number, zoom: number): [number, number] {
  const edge = 2 ** zoom;
  const clamped = Math.max(-MAX_LATITUDE, Math.min(MAX_LATITUDE, latitude));
  const y = ((1 - Math.asinh(Math.tan(clamped * RADIANS)) / Math.PI) / 2) * edge;
  const limit = (value: number): number => Math.max(0, Math.min(edge - 1, Math.floor(value)));
  return [limit(((longitude + 180) / 360) * edge), limit(y)];
}
