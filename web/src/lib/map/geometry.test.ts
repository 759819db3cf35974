import { describe, expect, it } from 'vitest';

import { baseKind, baseProblem, mapStyle } from './base';
import { bearing, boundsOf, circle, destination, distance, pathLength, widened } from './geometry';
import { angleText, graticule, graticuleStep, scaleLength } from './graticule';
import { DARK, vehicleColour } from './palette';
import { Projection } from './projection';
import { FleetTracks, Track, trackFeatures } from './track';
import { roomFor, vehicleAt } from './vehicleLayer';

const ZERMATT = { latitude: 46.02, longitude: 7.749 };

describe('geometry', () => {
  it('goes out and back', () => {
    const place = destination(ZERMATT, 75, 1234);
    expect(distance(ZERMATT, place)).toBeCloseTo(1234, 3);
    expect(bearing(ZERMATT, place)).toBeCloseTo(75, 6);
  });

  it('crosses the date line', () => {
    const place = destination({ latitude: 0, longitude: 179.999 }, 90, 1000);
    expect(place.longitude).toBeLessThan(-179.9);
    const bounds = boundsOf([{ latitude: 0, longitude: 179.999 }, place])!;
    expect(bounds.east - bounds.west).toBeLessThan(0.02);
    expect(boundsOf([])).toBeNull();
  });

  it('closes circles and adds up lines', () => {
    const round = circle(ZERMATT, 100, 36);
    expect(round[0]).toEqual(round[36]);
    expect(pathLength(round)).toBeCloseTo(2 * Math.PI * 100, -1);
  });

  it('widens bounds of a single place', () => {
    const bounds = widened(boundsOf([ZERMATT])!, 100);
    const [south, north] = [bounds.south, bounds.north].map((latitude) => ({ latitude, longitude: 0 }));
    expect(distance(south!, north!)).toBeCloseTo(100, 0);
  });
});

describe('projection', () => {
  const view = { ...ZERMATT, zoom: 15, bearing: 37, width: 800, height: 600 };

  it('goes from pixels to places and back, turned too', () => {
    const projection = new Projection(view);
    const place = projection.toPlace(123, 456);
    const pixel = projection.toPixel(place.latitude, place.longitude);
    expect(pixel.x).toBeCloseTo(123, 6);
    expect(pixel.y).toBeCloseTo(456, 6);
  });

  it('has the scale of the ground', () => {
    const projection = new Projection({ ...view, bearing: 0 });
    const east = destination(ZERMATT, 90, 100);
    const pixel = projection.toPixel(east.latitude, east.longitude);
    expect(pixel.x - 400).toBeCloseTo(100 * projection.pixelsPerMetre(46.02), 0);
    expect(pixel.y).toBeCloseTo(300, 0);
  });

  it('shows east on top when turned by 90 degrees', () => {
    const projection = new Projection({ ...view, bearing: 90 });
    const east = destination(ZERMATT, 90, 100);
    expect(projection.toPixel(east.latitude, east.longitude).y).toBeLessThan(300);
  });

  it('finds the vehicle below a finger, the nearest one', () => {
    const projection = new Projection(view);
    const near = { ...ZERMATT, system: 1 };
    const far = { ...destination(ZERMATT, 0, 5), system: 2 };
    expect(vehicleAt(projection, [far, near], { x: 401, y: 300 })?.system).toBe(1);
    expect(vehicleAt(projection, [far, near], { x: 10, y: 10 })).toBeNull();
  });
});

it('writes captions only where there is room', () => {
  const at = (x: number, y: number) => ({ text: '1 · 30 m', x, y });
  expect(roomFor([at(0, 0), at(20, 5), at(20, 20), at(90, 0)])).toEqual([0, 2, 3]);
});

describe('graticule', () => {
  it('takes steps that people read', () => {
    expect(graticuleStep(360)).toBe(45);
    expect(graticuleStep(0.01) * 3600).toBeCloseTo(5, 6);
  });

  it('has a bounded number of lines at every zoom', () => {
    for (let zoom = 1; zoom <= 23; zoom += 1) {
      const projection = new Projection({ ...ZERMATT, zoom, bearing: 20, width: 1440, height: 900 });
      const { latitudes, longitudes } = graticule(projection.bounds());
      expect(longitudes.length, `zoom ${zoom}`).toBeGreaterThan(2);
      expect(latitudes.length + longitudes.length, `zoom ${zoom}`).toBeLessThan(60);
    }
  });

  it('writes angles as exactly as the step needs', () => {
    expect(angleText(45, 45, 'latitude')).toBe('45°N');
    expect(angleText(-7.75, 1 / 60, 'longitude')).toBe('7°45′W');
    expect(angleText(47.391666666, 5 / 3600, 'latitude')).toBe('47°23′30″N');
    expect(angleText(7.5 + 0.5 / 3600, 0.5 / 3600, 'longitude')).toBe('7°30′00.5″E');
    expect(angleText(190, 5, 'longitude')).toBe('170°W');
    expect(angleText(0, 5, 'latitude')).toBe('0°');
  });

  it('has a round scale bar that fits', () => {
    expect(scaleLength(0.5, 120)).toBe(200);
    expect(scaleLength(4, 120)).toBe(20);
  });
});

describe('track', () => {
  it('keeps places that are apart, and forgets half of the old ones when it is full', () => {
    const track = new Track({ capacity: 100, spacing: 5 });
    expect(track.add(ZERMATT)).toBe(true);
    expect(track.add(destination(ZERMATT, 90, 2))).toBe(false);
    for (let index = 1; index < 400; index += 1) track.add(destination(ZERMATT, 90, index * 10));
    expect(track.places.length).toBeLessThanOrEqual(100);
    expect(distance(ZERMATT, track.places.at(-1)!)).toBeCloseTo(3990, 0);
    expect(track.places[0]).toEqual(ZERMATT);
  });

  it('shares its places with the tracks of vehicles that are found later', () => {
    const tracks = new FleetTracks();
    const places = Array.from({ length: 5000 }, (_, index) => destination(ZERMATT, 90, index * 3));
    for (let system = 1; system <= 100; system += 1) for (const place of places) tracks.of(system).add(place);
    const total = (): number => [...tracks.all.values()].reduce((sum, { places: { length } }) => sum + length, 0);
    expect(total()).toBeLessThanOrEqual(40_000);
    expect(total()).toBeGreaterThan(25_000);
    expect(tracks.of(1).places.at(-1)).toEqual(places.at(-1));

    tracks.keep(new Set([1, 2]));
    for (const place of places) tracks.of(1).add(place);
    expect([...tracks.all.keys()]).toEqual([1, 2]);
    expect(tracks.of(1).places.length).toBeGreaterThan(2500);
  });

  it('begins again after a jump', () => {
    const track = new Track();
    track.add(ZERMATT);
    track.add({ latitude: 0, longitude: 0 });
    expect(track.places).toHaveLength(1);
  });

  it('is one source, also across the date line', () => {
    const track = new Track();
    track.add({ latitude: 0, longitude: 179.99 });
    track.add({ latitude: 0, longitude: -179.99 });
    const { features } = trackFeatures([
      [track, '#fff'],
      [new Track(), '#000'],
    ]);
    expect(features).toHaveLength(1);
    expect(features[0]!.geometry.coordinates[1]![0]).toBeCloseTo(180.01, 9);
  });
});

describe('base map', () => {
  it('tells kinds and problems of URLs', () => {
    expect(['', ' ', 'https://t/{z}/{x}/{y}.png', '/maps/a.pmtiles', 'pmtiles://https://h/a'].map(baseKind)).toEqual([
      'none',
      'none',
      'raster',
      'pmtiles',
      'pmtiles',
    ]);
    expect(baseProblem('https://t/{z}/{x}.png')).toBe('the URL has no {y}');
    expect(baseProblem('tiles/{z}/{x}/{y}')).toMatch('must begin with');
    expect(baseProblem('https://t/{z}/{x}/{y}.png')).toBeNull();
  });

  it('needs nothing from the internet without a URL: no sources but the tracks, no glyphs', () => {
    const style = mapStyle({ url: '', attribution: '' }, DARK);
    expect(Object.keys(style.sources)).toEqual(['tracks']);
    expect(style.glyphs).toBeUndefined();
    expect(style.sprite).toBeUndefined();
  });

  it('draws tiles below the tracks, vector archives by the layers they have', () => {
    const raster = mapStyle({ url: 'https://t/{z}/{x}/{y}.png', attribution: 'T' }, DARK);
    expect(raster.layers.map((layer) => layer.id)).toEqual(['base', 'tracks-halo', 'tracks']);
    const archive = { isVector: true, maxZoom: 14, layers: ['water', 'roads', 'places'] };
    const vector = mapStyle({ url: 'https://t/a.pmtiles', attribution: 'T' }, DARK, archive);
    expect(vector.layers.map((layer) => layer.id)).toEqual(['base-water', 'base-roads', 'tracks-halo', 'tracks']);
  });

  it('gives eight vehicles in a row different colours', () => {
    expect(new Set([1, 2, 3, 4, 5, 6, 7, 8].map((system) => vehicleColour(system, true))).size).toBe(8);
  });
});
