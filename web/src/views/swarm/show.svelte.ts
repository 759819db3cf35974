/** A show that the station has checked, and its preview over time. */

import { api } from '$lib/api/client';

import { placeAt } from './showTracks';
import type { Slot } from './slots';

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

  /** Where each vehicle is at the time: metres ahead, right and up of the origin. */
  readonly places: readonly Slot[] = $derived.by(() => {
    const { preview, time } = this;
    return preview === null ? [] : preview.tracks.map(({ places }) => placeAt(places, time / preview.duration_s));
  });

  async open(file: File): Promise<void> {
    this.isPlaying = false;
    this.preview = await api.postBytes<ShowPreview>('shows', file, { name: file.name });
    this.time = 0;
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
    this.isPlaying = false;
  }
}

export const show = new ShowView();
