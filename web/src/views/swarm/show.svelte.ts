/** A show that the station has checked, its preview over time, and its flight. */

import { api } from '$lib/api/client';
import type { Place } from '$lib/map/geometry';

import { placeAt } from './showTracks';
import type { Slot } from './slots';
import { swarm } from './swarm.svelte';

/** Metres above home to which vehicles take off before a show. */
const ALTITUDE = 10;

export interface ShowPreview {
  readonly name: string;
  readonly duration_s: number;
  readonly separation_m: number | null;
  readonly limit_m: number;
  readonly speed_m_s: number;
  readonly climb_m_s: number;
  readonly acceleration_m_s2: number;
  readonly problems: readonly string[];
  readonly tracks: readonly { readonly name: string; readonly places: readonly Slot[] }[];
}

class ShowView {
  preview: ShowPreview | null = $state.raw(null);
  /** Seconds since the begin. */
  time = $state(0);
  isPlaying = $state(false);
  /** Direction of the x axis in degrees, clockwise from north. */
  orientation: number | null = $state(0);

  /** The vehicles that fly it, as a person has chosen them. */
  systems: readonly number[] = $state.raw([]);
  /** Arm and take off before the flight. */
  takeoff = $state(false);
  private file: File | null = null;

  /** Where each vehicle is at the time: metres ahead, right and up of the origin. */
  readonly places: readonly Slot[] = $derived.by(() => {
    const { preview, time } = this;
    return preview === null ? [] : preview.tracks.map(({ places }) => placeAt(places, time / preview.duration_s));
  });

  async open(file: File): Promise<void> {
    this.isPlaying = false;
    this.preview = await api.postBytes<ShowPreview>('shows', file, { name: file.name });
    this.file = file;
    this.systems = [];
    this.time = 0;
  }

  /** Flies the show with the chosen vehicles, around a place; resolves at its end. */
  async fly(origin: Place | null): Promise<void> {
    const { file, systems } = this;
    const orientation = this.orientation ?? 0;
    if (file === null) return;
    if (this.takeoff) await api.longJson('POST', 'swarm/takeoff', undefined, { systems, altitude: ALTITUDE });
    if (this.file !== file) return;
    await api.longJson('POST', 'swarm/show', undefined, file, {
      name: file.name,
      systems: systems.join(','),
      orientation,
      ...(origin === null ? {} : { latitude: origin.latitude, longitude: origin.longitude }),
    });
    await swarm.refresh();
  }

  toggle(): void {
    const { preview } = this;
    if (preview === null) return;
    if (!this.isPlaying && this.time >= preview.duration_s) this.time = 0;
    this.isPlaying = !this.isPlaying;
  }

  /** Plays on by some seconds; stops at the end. */
  advance(seconds: number): void {
    const { preview } = this;
    if (preview === null || !this.isPlaying) return;
    this.time = Math.min(this.time + seconds, preview.duration_s);
    this.isPlaying = this.time < preview.duration_s;
  }

  close(): void {
    this.preview = null;
    this.file = null;
    this.isPlaying = false;
  }
}

export const show = new ShowView();
