/** MapLibre, loaded when a map is shown first: its worker comes from the station itself, nothing from elsewhere. */
import type { Map as MapLibreMap, MapOptions } from 'maplibre-gl';
import workerUrl from 'maplibre-gl/dist/maplibre-gl-worker.mjs?url';

import type { ArchiveInfo, BaseMap } from './base';
import { baseKind, baseProblem, STATION_MAP } from './base';
import { archiveOf, stationMaps } from './stationMaps.svelte';

type Engine = typeof import('maplibre-gl');

const MVT = 1;
let loading: Promise<Engine> | null = null;

/** Return MapLibre with its worker and the protocol `pmtiles:` set up. */
export function loadEngine(): Promise<Engine> {
  loading ??= setUp();
  return loading;
}

async function setUp(): Promise<Engine> {
  const [engine, { Protocol }] = await Promise.all([
    import('maplibre-gl'),
    import('pmtiles'),
    import('maplibre-gl/dist/maplibre-gl.css'),
  ]);
  engine.setWorkerUrl(workerUrl);
  engine.addProtocol('pmtiles', new Protocol().tile);
  return engine;
}

/** Create a map that is never tilted and has no controls of its own. */
export async function createMap(options: MapOptions): Promise<MapLibreMap> {
  const engine = await loadEngine();
  const map = new engine.Map({
    attributionControl: false,
    maxPitch: 0,
    pitchWithRotate: false,
    touchPitch: false,
    fadeDuration: 0,
    maxZoom: 23,
    minZoom: 1,
    ...options,
  });
  leaveOutSky(map);
  map.on('webglcontextrestored', () => leaveOutSky(map));
  return map;
}

/** MapLibre computes the sky for each pixel of each frame; a map that is never tilted shows none of it. */
function leaveOutSky({ painter }: MapLibreMap): void {
  painter.drawFunctions = { ...painter.drawFunctions, sky: () => undefined };
}

/** Return what the archive of a base map holds, or null if the base map is something else. */
export async function readArchive(base: BaseMap): Promise<ArchiveInfo | null> {
  if (baseKind(base.url) === 'station')
    return archiveOf(await stationMaps.find(base.url.trim().slice(STATION_MAP.length)));
  if (baseKind(base.url) !== 'pmtiles' || baseProblem(base.url) !== null) return null;
  const { PMTiles } = await import('pmtiles');
  const address = base.url.trim().replace(/^pmtiles:\/\//i, '');
  const archive = new PMTiles(new URL(address, location.href).href);
  const header = await archive.getHeader();
  const isVector = header.tileType === MVT;
  const metadata = isVector ? ((await archive.getMetadata()) as { vector_layers?: { id: string }[] }) : {};
  return { isVector, maxZoom: header.maxZoom, layers: (metadata.vector_layers ?? []).map((layer) => layer.id) };
}
