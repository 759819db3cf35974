/** The base layer: nothing but a background, raster tiles of a URL, a PMTiles archive, or a map of the station. */
import type { LayerSpecification, SourceSpecification, StyleSpecification } from 'maplibre-gl';

import type { MapPalette } from './palette';

export interface BaseMap {
  /** `https://host/{z}/{x}/{y}.png`, the URL of a `.pmtiles` file, `station:NAME`, or empty for the graticule alone. */
  readonly url: string;
  /** Credit that the owner of the tiles asks for. */
  readonly attribution: string;
  readonly maxZoom?: number;
}

export const NO_BASE: BaseMap = { url: '', attribution: '' };
export const BASE_SOURCE = 'base';
export const TRACK_SOURCE = 'tracks';

export type BaseKind = 'none' | 'raster' | 'pmtiles' | 'station';

/** Begins the address of a map that the station serves; its name follows. */
export const STATION_MAP = 'station:';

/** Return which kind of base layer a URL names. */
export function baseKind(url: string): BaseKind {
  const trimmed = url.trim();
  if (trimmed === '') return 'none';
  if (trimmed.startsWith(STATION_MAP)) return 'station';
  return /^pmtiles:|\.pmtiles([?#]|$)/i.test(trimmed) ? 'pmtiles' : 'raster';
}

/** Return the problem of a tile URL in words, or null if it can be used. */
export function baseProblem(url: string): string | null {
  const kind = baseKind(url);
  if (kind === 'none' || kind === 'station') return null;
  const address = url.trim().replace(/^pmtiles:\/\//i, '');
  if (!/^(https?:\/\/|\/)/i.test(address)) return 'the URL must begin with http://, https:// or /';
  const missing = ['{z}', '{x}', '{y}'].filter((part) => !address.includes(part));
  return kind === 'raster' && missing.length > 0 ? `the URL has no ${missing.join(', ')}` : null;
}

/** Contents of a PMTiles archive, or of a map of the station. */
export interface ArchiveInfo {
  readonly isVector: boolean;
  readonly maxZoom: number;
  readonly layers: readonly string[];
  /** Of a map of the station: the tiles, their lowest zoom level, and west, south, east and north in degrees. */
  readonly tiles?: string;
  readonly minZoom?: number;
  readonly bounds?: readonly [number, number, number, number];
}

/** Return the MapLibre style of a base map; `archive` is what a PMTiles file says of itself. */
export function mapStyle(base: BaseMap, palette: MapPalette, archive: ArchiveInfo | null = null): StyleSpecification {
  const sources: Record<string, SourceSpecification> = {
    [TRACK_SOURCE]: { type: 'geojson', data: { type: 'FeatureCollection', features: [] } },
  };
  // The background is that of the element behind the map: a layer of it would be computed for each pixel of each frame.
  const layers: LayerSpecification[] = [];
  const kind = baseProblem(base.url) === null ? baseKind(base.url) : 'none';
  const address = base.url.trim().replace(/^pmtiles:\/\//i, '');
  if (kind === 'raster') {
    sources[BASE_SOURCE] = { type: 'raster', tiles: [absolute(address)], tileSize: 256, maxzoom: base.maxZoom ?? 19 };
    layers.push(rasterLayer(palette));
  } else if (kind === 'pmtiles' && archive !== null) {
    const url = `pmtiles://${absolute(address)}`;
    if (archive.isVector) {
      sources[BASE_SOURCE] = { type: 'vector', url };
      layers.push(...vectorLayers(archive.layers, palette));
    } else {
      sources[BASE_SOURCE] = { type: 'raster', url, tileSize: 256, maxzoom: archive.maxZoom };
      layers.push(rasterLayer(palette));
    }
  }
  if (kind === 'station' && archive?.tiles !== undefined) {
    const { isVector, tiles, minZoom = 0, maxZoom, bounds } = archive;
    const shared = { tiles: [tiles], minzoom: minZoom, maxzoom: maxZoom, ...(bounds ? { bounds: [...bounds] } : {}) };
    sources[BASE_SOURCE] = (
      isVector ? { type: 'vector', ...shared } : { type: 'raster', tileSize: 256, ...shared }
    ) as SourceSpecification;
    layers.push(...(isVector ? vectorLayers(archive.layers, palette) : [rasterLayer(palette)]));
  }
  layers.push(
    {
      id: 'tracks-halo',
      type: 'line',
      source: TRACK_SOURCE,
      layout: { 'line-cap': 'round', 'line-join': 'round' },
      paint: { 'line-color': palette.halo, 'line-width': 4.2, 'line-opacity': 0.7 },
    },
    {
      id: 'tracks',
      type: 'line',
      source: TRACK_SOURCE,
      layout: { 'line-cap': 'round', 'line-join': 'round' },
      paint: { 'line-color': ['get', 'colour'], 'line-width': 2.2 },
    },
  );
  return { version: 8, sources, layers };
}

function absolute(address: string): string {
  return address.startsWith('/') && typeof location !== 'undefined' ? `${location.origin}${address}` : address;
}

/** Bright tiles are dimmed in the dark theme, so that symbols stay readable and the eyes adapted. */
function rasterLayer(palette: MapPalette): LayerSpecification {
  const paint = palette.isDark ? { 'raster-brightness-max': 0.62, 'raster-saturation': -0.25 } : {};
  return { id: 'base', type: 'raster', source: BASE_SOURCE, paint };
}

/** Names of layers in the two usual schemas (Protomaps, OpenMapTiles) and how they are drawn. */
const AREAS: readonly (readonly [names: readonly string[], dark: string, light: string])[] = [
  [['earth'], '#18222e', '#f4f3ee'],
  [['landcover', 'landuse', 'park'], '#1b2a2a', '#e6eddb'],
  [['water'], '#0c2036', '#bcd8ee'],
  [['buildings', 'building'], '#273442', '#dcd8d0'],
];
const LINES: readonly (readonly [names: readonly string[], dark: string, light: string, width: number])[] = [
  [['waterway'], '#153454', '#9fc6e6', 1],
  [['boundaries', 'boundary'], '#56657a', '#8c8c9c', 1],
  [['roads', 'transportation'], '#3c4a5c', '#b4aca0', 1.4],
];

function vectorLayers(present: readonly string[], palette: MapPalette): LayerSpecification[] {
  const pick = (dark: string, light: string): string => (palette.isDark ? dark : light);
  const layers: LayerSpecification[] = [];
  for (const [names, dark, light] of AREAS) {
    for (const name of names.filter((candidate) => present.includes(candidate))) {
      layers.push({
        id: `base-${name}`,
        type: 'fill',
        source: BASE_SOURCE,
        'source-layer': name,
        filter: ['==', ['geometry-type'], 'Polygon'],
        paint: { 'fill-color': pick(dark, light) },
      });
    }
  }
  for (const [names, dark, light, width] of LINES) {
    for (const name of names.filter((candidate) => present.includes(candidate))) {
      layers.push({
        id: `base-${name}`,
        type: 'line',
        source: BASE_SOURCE,
        'source-layer': name,
        paint: { 'line-color': pick(dark, light), 'line-width': width },
      });
    }
  }
  return layers;
}
