/**
 * Whether the tiles of the base map come; a map that is used offline keeps its graticule, and the console stays empty.
 */
import type { Map as MapLibreMap } from 'maplibre-gl';

import { BASE_SOURCE, baseKind, type BaseMap } from './base';

export class TileWatch {
  /** No tile came yet, and none failed. */
  private awaits = false;

  /**
   * Watches a map.
   *
   * @param onfail - Called once for a base map whose first tile cannot be read.
   */
  constructor(map: Pick<MapLibreMap, 'on'>, onfail: () => void) {
    map.on('error', (event) => {
      if (!this.awaits || !('sourceId' in event) || event.sourceId !== BASE_SOURCE) return;
      this.awaits = false;
      onfail();
    });
    map.on('sourcedata', ({ sourceId, tile }) => {
      if (sourceId === BASE_SOURCE && tile) this.awaits = false;
    });
  }

  /** Waits for the tiles of another base map; an archive tells its own problems. */
  restart(base: BaseMap): void {
    this.awaits = baseKind(base.url) === 'raster';
  }
}
