/** The swarm of the station: its state, the preview of a formation, and the plan of a search. */

import { api } from '$lib/api/client';
import { textOf } from '$lib/api/errors';
import type { Place } from '$lib/map/geometry';
import { fleet } from '$lib/store/fleet.svelte';
import { uploadShares, type Share } from '$lib/vehicle/shares';

import { positiveOrNull, type Slot } from './slots';

export interface SwarmState {
  readonly active: boolean;
  readonly action: string | null;
  readonly reason: string | null;
  readonly paused: boolean;
  readonly leader: number | null;
  readonly systems: readonly number[];
  readonly course_deg: number | null;
  readonly separation_m: number | null;
  readonly nearest_pair: readonly [number, number] | null;
  readonly smallest_separation_m: number | null;
  /** Null without a swarm. */
  readonly limit_m: number | null;
  readonly members: readonly { readonly system: number; readonly follows: boolean }[];
}

export const PATTERNS = ['parallel', 'creeping', 'square', 'sector'] as const;

class SwarmView {
  state: SwarmState | null = $state.raw(null);
  formations: Readonly<Record<string, string>> = $state.raw({});
  slots: readonly Slot[] = $state.raw([]);
  shares: readonly Share[] = $state.raw([]);
  problem: string | null = $state(null);
  /** The place that was clicked. */
  place: Place | null = $state.raw(null);
  /** System ids of the members; empty: all vehicles. */
  chosen: readonly number[] = $state.raw([]);
  lead: number | null = $state(null);
  shape = $state('wedge');
  spacing: number | null = $state(10);
  angle = $state(45);
  rotation = $state(0);
  layers = $state(1);
  layerSpacing = $state(0);
  text = $state('');
  altitude: number | null = $state(null);
  takeoff = $state(false);
  pattern: (typeof PATTERNS)[number] = $state('parallel');
  size: number | null = $state(200);
  track: number | null = $state(20);

  /** The members of the next call, as the station chooses them. */
  readonly systems: readonly number[] = $derived.by(() => {
    if (this.chosen.length > 0) return this.chosen;
    if (this.state?.active) return this.state.systems;
    return fleet.vehicles.filter(({ state }) => state.alive).map(({ system }) => system);
  });
  readonly leader: number | null = $derived(
    [this.lead, this.state?.leader, this.systems[0]].find((each) => each != null && this.systems.includes(each)) ??
      null,
  );

  /** The fields of a formation, as requests have them. */
  get fields(): object {
    return {
      shape: this.shape,
      spacing: positiveOrNull(this.spacing),
      angle: this.angle,
      rotation: this.rotation,
      layers: this.layers,
      layer_spacing: this.layerSpacing,
      text: this.text,
    };
  }

  /** The members of a call. */
  get members(): object {
    return { systems: this.chosen.length > 0 ? this.chosen : null, lead: this.lead };
  }

  async refresh(): Promise<void> {
    this.state = await api.get<SwarmState>('swarm');
  }

  async readFormations(): Promise<void> {
    const found = await api.get<Record<string, string>>('swarm/formations');
    // Points are those of programs.
    this.formations = Object.fromEntries(Object.entries(found).filter(([name]) => name !== 'points'));
  }

  async preview(): Promise<void> {
    const count = Math.max(1, this.systems.length);
    try {
      this.slots = (await api.post<{ slots: Slot[] }>('swarm/preview', { ...this.fields, count })).slots;
      this.problem = null;
    } catch (error) {
      this.slots = [];
      this.problem = textOf(error);
    }
  }

  /** Flies an action; resolves when the members have arrived. */
  async fly(action: string, fields: object = {}): Promise<void> {
    await api.longJson('POST', `swarm/${action}`, undefined, { ...this.members, ...fields });
    await this.refresh();
  }

  async formUp(): Promise<void> {
    await this.fly('formation', {
      ...this.fields,
      altitude: positiveOrNull(this.altitude),
      takeoff: this.takeoff,
    });
  }

  /** Ends the flight: these vehicles, by default the members of the next call, hold where they are. */
  async stop(members = this.members): Promise<void> {
    await api.post('swarm/stop', members);
    await this.refresh();
  }

  /** Pauses the flight, or continues it. */
  async pause(paused: boolean): Promise<void> {
    this.state = await api.post<SwarmState>(paused ? 'swarm/pause' : 'swarm/resume');
  }

  async end(): Promise<void> {
    this.state = await api.delete<SwarmState>('swarm');
  }

  /** Divides a search around a place among the members. */
  async planSearch(centre: Place): Promise<void> {
    const vehicles = this.systems.map((system) => ({ system }));
    const body = {
      pattern: this.pattern,
      center: [centre.latitude, centre.longitude],
      size: positiveOrNull(this.size),
      spacing: positiveOrNull(this.track),
      ...(positiveOrNull(this.altitude) === null ? {} : { altitude: this.altitude }),
      vehicles,
    };
    this.shares = (await api.post<{ shares: Share[] }>('searches', body)).shares;
  }

  /** Uploads each share to its vehicle; those that fly start it. */
  async uploadSearch(): Promise<void> {
    for (const vehicle of await uploadShares(this.shares))
      if (vehicle.state.armed === true) await vehicle.startMission();
  }
}

export const swarm = new SwarmView();
