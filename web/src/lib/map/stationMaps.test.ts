import { describe, expect, it } from 'vitest';

import { mapStyle } from './base';
import { LIGHT } from './palette';
import { archiveOf, countTiles, type StationMap } from './stationMaps.svelte';

const FIELD: StationMap = {
  name: 'field',
  format: 'png',
  encoding: '',
  attribution: '© us',
  area: { south: 47.39, west: 8.53, north: 47.41, east: 8.56 },
  min_zoom: 10,
  max_zoom: 16,
  layers: [],
  tiles: 9,
  size: 9,
};

describe('maps of the station', () => {
  it('are base maps of pictures, within their area', () => {
    const style = mapStyle({ url: 'station:field', attribution: '' }, LIGHT, archiveOf(FIELD));
    expect(style.sources.base).toMatchObject({
      type: 'raster',
      minzoom: 10,
      maxzoom: 16,
      bounds: [8.53, 47.39, 8.56, 47.41],
    });
    expect((style.sources.base as { tiles: string[] }).tiles[0]).toMatch(/maps\/field\/\{z\}\/\{x\}\/\{y\}$/);
  });

  it('are base maps of vectors', () => {
    const archive = archiveOf({ ...FIELD, format: 'pbf', layers: ['water'], area: null });
    const style = mapStyle({ url: 'station:field', attribution: '' }, LIGHT, archive);
    expect(style.sources.base).toMatchObject({ type: 'vector' });
    expect(style.layers.map((layer) => layer.id)).toContain('base-water');
  });

  it('have as many tiles as the station counts', () => {
    // The numbers of mavstack.maps.count_tiles.
    expect(countTiles({ south: 47.39, west: 8.53, north: 47.41, east: 8.56 }, 12, 15)).toBe(24);
    expect(countTiles({ south: -17, west: 179, north: -16, east: -179 }, 8, 8)).toBe(4);
    expect(countTiles({ south: -80, west: -180, north: 80, east: 180 }, 0, 2)).toBe(21);
  });
});
