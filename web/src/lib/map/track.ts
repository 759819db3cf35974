/** The way that a vehicle has taken: a bounded list of places, thinned where it is straight. */
import type { FeatureCollection, LineString } from 'geojson';

import { distance, type Place } from './geometry';

export interface TrackOptions {
  /** Places kept at most; beyond it every second old one is dropped. */
  readonly capacity?: number;
  /** Metres between places. */
  readonly spacing?: number;
}

const JUMP = 20_000;

export class Track {
  private capacity: number;
  private readonly spacing: number;
  private kept: Place[] = [];
  /** Changes with each place that is kept. */
  revision = 0;

  constructor({ capacity = 2000, spacing = 1 }: TrackOptions = {}) {
    this.capacity = capacity;
    this.spacing = spacing;
  }

  get places(): readonly Place[] {
    return this.kept;
  }

  /** Add a place; return whether it is kept. A jump of more than 20 km begins a new track. */
  add(place: Place): boolean {
    const last = this.kept[this.kept.length - 1];
    if (last !== undefined) {
      const gap = distance(last, place);
      if (gap < this.spacing) return false;
      if (gap > JUMP) this.kept = [];
    }
    this.kept.push({ latitude: place.latitude, longitude: place.longitude });
    if (this.kept.length > this.capacity) this.thin();
    this.revision += 1;
    return true;
  }

  /** Sets how many places are kept at most. */
  limit(capacity: number): void {
    this.capacity = capacity;
    while (this.kept.length > this.capacity) {
      this.thin();
      this.revision += 1;
    }
  }

  clear(): void {
    this.kept = [];
    this.revision += 1;
  }

  /** Keep the newer half as it is and every second place of the older half. */
  private thin(): void {
    const half = Math.floor(this.kept.length / 2);
    this.kept = this.kept.filter((_, index) => index >= half || index % 2 === 0);
  }
}

/** Places of all tracks together; a large fleet gets shorter tracks. */
const MAX_PLACES = 40_000;
/** Places of one track, whatever the number of tracks. */
const MIN_CAPACITY = 200;
const MAX_CAPACITY = 4000;

/** The tracks of a fleet by system id, which share a number of places. */
export class FleetTracks {
  private readonly tracks = new Map<number, Track>();

  /** The tracks that were begun. */
  get all(): ReadonlyMap<number, Track> {
    return this.tracks;
  }

  /** Returns the track of a vehicle; begins it, for which all others may get shorter. */
  of(system: number): Track {
    const known = this.tracks.get(system);
    if (known !== undefined) return known;
    const track = new Track();
    this.tracks.set(system, track);
    this.share();
    return track;
  }

  /** Drops the tracks of other vehicles than these. */
  keep(systems: ReadonlySet<number>): void {
    for (const system of this.tracks.keys()) if (!systems.has(system)) this.tracks.delete(system);
    this.share();
  }

  private share(): void {
    const share = Math.floor(MAX_PLACES / Math.max(1, this.tracks.size));
    for (const track of this.tracks.values()) track.limit(Math.min(MAX_CAPACITY, Math.max(MIN_CAPACITY, share)));
  }
}

export type TrackFeatures = FeatureCollection<LineString, { colour: string }>;

/** Return tracks as the GeoJSON of one source. */
export function trackFeatures(tracks: Iterable<readonly [Track, string]>): TrackFeatures {
  const features: TrackFeatures['features'] = [];
  for (const [track, colour] of tracks) {
    if (track.places.length < 2) continue;
    let last = track.places[0]!.longitude;
    const coordinates = track.places.map(({ latitude, longitude }) => {
      // Beyond 180 rather than back around the world.
      last += ((((longitude - last + 180) % 360) + 360) % 360) - 180;
      return [last, latitude];
    });
    features.push({ type: 'Feature', geometry: { type: 'LineString', coordinates }, properties: { colour } });
  }
  return { type: 'FeatureCollection', features };
}
