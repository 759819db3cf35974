/** The heights of the terrain below a plan: files, tiles of an address, or a map of the station, in this order. */

import { type StationMap, stationMaps, tilesOf } from '$lib/map/stationMaps.svelte';
import { Persisted } from '$lib/store/settings.svelte';

import {
  type ElevationSource,
  type HgtFile,
  hgtSource,
  loadPicture,
  type TileEncoding,
  tileSource,
} from './logic/elevation';

class Heights {
  files: readonly HgtFile[] = $state.raw([]);
  readonly tiles = new Persisted('plan.terrainTiles', '');
  readonly encoding = new Persisted<TileEncoding>('plan.terrainEncoding', 'terrarium');
  /** The map of the station; null: none is there, or files or an address are given. */
  readonly map: StationMap | null = $derived(
    this.files.length > 0 || this.tiles.value.trim() !== '' ? null : (stationMaps.heights[0] ?? null),
  );
  /** The heights; null: they are not known. */
  readonly source: ElevationSource | null = $derived.by(() => {
    if (this.files.length > 0) return hgtSource(this.files);
    const address = this.tiles.value.trim();
    if (address !== '') return tileSource(address, this.encoding.value);
    const { map } = this;
    return map && tileSource(tilesOf(map.name), map.encoding as TileEncoding, loadPicture, map.max_zoom);
  });
}

export const heights = new Heights();
