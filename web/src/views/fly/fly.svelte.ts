/** Tracks, traffic, plans, chosen vehicles and targets: the fly view keeps them while other views are shown. */
import type { Place } from '$lib/map/geometry';
import { vehicleColour } from '$lib/map/palette';
import { fenceShapes, type FenceShape, type MissionPath, missionPath, rallyPlaces } from '$lib/map/plan';
import { pageTheme } from '$lib/map/theme.svelte';
import { FleetTracks, type TrackFeatures, trackFeatures } from '$lib/map/track';
import { type Aircraft, aircraftFrom, TRAFFIC_TIMEOUT } from '$lib/map/traffic';
import { fleet } from '$lib/store/fleet.svelte';
import { Persisted } from '$lib/store/settings.svelte';
import { status } from '$lib/store/status.svelte';
import type { PlanItem, PlanKind, Vehicle } from '$lib/vehicle/Vehicle';

import type { Spot } from './formation';

const TRACK_INTERVAL = 200;
const SLOW_TICKS = 5;
/** The map draws all tracks again when one has changed; in between the newest places are drawn with the vehicle. */
const TRACK_TICKS = 10;
const MAX_TAIL = TRACK_TICKS + SLOW_TICKS;
/** A receiver hears some hundreds of aircraft at most. */
const MAX_AIRCRAFT = 500;

export interface VehiclePlans {
  readonly mission: readonly PlanItem[];
  readonly fence: readonly FenceShape[];
  readonly rally: readonly Place[];
}

/** Where vehicles were sent. */
export interface FlightTarget {
  readonly spots: readonly Spot[];
  /** Of the circle that they fly there, in m. */
  readonly radius: number | null;
}

/** A distance that is measured; `to` is null until a second place is chosen. */
export interface Ruler {
  readonly from: Place;
  readonly to: Place | null;
}

const NO_PLANS: VehiclePlans = { mission: [], fence: [], rally: [] };

class FlyState {
  /** Vehicles chosen for common actions; empty: the selected one. */
  chosen: readonly number[] = $state.raw([]);
  groups = new Persisted<Readonly<Record<string, readonly number[]>>>('fly.groups', {});
  isFollowing = $state(false);
  tracks: TrackFeatures = $state.raw({ type: 'FeatureCollection', features: [] });
  traffic: readonly Aircraft[] = $state.raw([]);
  plans: Readonly<Record<number, VehiclePlans>> = $state.raw({});
  target: FlightTarget | null = $state.raw(null);
  ruler: Ruler | null = $state.raw(null);
  /** The present time in ms since 1970, once a second. */
  now = $state(Date.now());
  /** When vehicles were first seen in the air. */
  takeoffs: Readonly<Record<number, number>> = $state.raw({});

  targets: readonly Vehicle[] = $derived.by(() => {
    // A choice whose vehicles are all away never falls back to another vehicle.
    if (this.chosen.length > 0) return fleet.vehicles.filter((vehicle) => this.chosen.includes(vehicle.system));
    return fleet.selected === null ? [] : [fleet.selected];
  });
  /** Changes with the vehicles of common actions. */
  targetKey: string = $derived(this.targets.map((vehicle) => vehicle.system).join());

  private readonly trackOf = new FleetTracks();
  private readonly reports = new Map<number, Aircraft>();
  private readonly planTotals = new Map<number, number | null>();
  private readonly paths = new Map<number, { mission: readonly PlanItem[]; home: Place | null; path: MissionPath }>();
  private ticks = 0;
  private drawn = '';
  private isStarted = false;

  /** Begins to watch the fleet; once, when the view is first shown. */
  start(): void {
    if (this.isStarted) return;
    this.isStarted = true;
    fleet.onMessage('ADSB_VEHICLE', (message) => this.takeTraffic(aircraftFrom(message.fields, message.time)));
    setInterval(() => this.tick(fleet.now()), TRACK_INTERVAL);
    $effect.root(() => {
      $effect(() => {
        // Another link: a choice by system ids would mean other vehicles there.
        void [status.source, status.linkName];
        this.chosen = [];
        this.target = null;
      });
    });
  }

  /** Returns the newest places of a vehicle's track: those of the time until the tracks are published and drawn. */
  trackEnd(system: number): readonly Place[] | null {
    return this.trackOf.all.get(system)?.places.slice(-MAX_TAIL) ?? null;
  }

  /** Keeps the newest report of an aircraft; of too many, those that were reported longest ago are dropped. */
  takeTraffic(aircraft: Aircraft | null): void {
    if (aircraft === null) return;
    this.reports.delete(aircraft.address);
    this.reports.set(aircraft.address, aircraft);
    if (this.reports.size > MAX_AIRCRAFT) this.reports.delete(this.reports.keys().next().value!);
  }

  /** Aircraft that were reported, the newest last. */
  get aircraft(): readonly Aircraft[] {
    return [...this.reports.values()];
  }

  toggle(system: number): void {
    const has = this.chosen.includes(system);
    this.chosen = has ? this.chosen.filter((each) => each !== system) : [...this.chosen, system];
  }

  /** Shows no more where vehicles were sent: they have got something else to do. */
  dropTargets(systems: readonly number[]): void {
    if (this.target === null) return;
    const spots = this.target.spots.filter(({ system }) => !systems.includes(system));
    this.target = spots.length === 0 ? null : { ...this.target, spots };
  }

  clearTracks(): void {
    for (const track of this.trackOf.all.values()) track.clear();
    this.publishTracks();
  }

  private tick(now: number): void {
    this.ticks += 1;
    for (const vehicle of fleet.vehicles) {
      const { position, inAir } = vehicle.state;
      const track = this.trackOf.of(vehicle.system);
      // Noise of a vehicle that stands is no track.
      if (position !== null && (inAir !== false || vehicle.state.armed)) track.add(position);
    }
    if (this.ticks % TRACK_TICKS === 0) this.publishTracks();
    if (this.ticks % SLOW_TICKS === 0) this.slowTick(now);
  }

  private slowTick(now: number): void {
    this.now = now;
    for (const [address, aircraft] of this.reports) {
      if (now - aircraft.time > TRAFFIC_TIMEOUT) this.reports.delete(address);
    }
    if (this.reports.size > 0 || this.traffic.length > 0) this.traffic = this.aircraft;
    this.followTakeoffs(now);
    this.forget();
  }

  private publishTracks(): void {
    const revisions = [...this.trackOf.all].map(([system, track]) => `${system}:${track.revision}`);
    const wanted = `${pageTheme.isDark} ${revisions.join()}`;
    if (wanted === this.drawn) return;
    this.drawn = wanted;
    const shown = [...this.trackOf.all].map(
      ([system, track]) => [track, vehicleColour(system, pageTheme.isDark)] as const,
    );
    this.tracks = trackFeatures(shown);
  }

  private followTakeoffs(now: number): void {
    const takeoffs: Record<number, number> = {};
    for (const { system, state } of fleet.vehicles) {
      if (state.inAir) takeoffs[system] = this.takeoffs[system] ?? now;
    }
    this.takeoffs = takeoffs;
  }

  /** Drops what belongs to vehicles of a link that was left. */
  private forget(): void {
    const present = new Set(fleet.vehicles.map((vehicle) => vehicle.system));
    for (const system of this.trackOf.all.keys()) {
      if (present.has(system)) continue;
      this.planTotals.delete(system);
      this.paths.delete(system);
    }
    this.trackOf.keep(present);
    if (fleet.vehicles.length > 0) return;
    if (Object.keys(this.plans).length > 0) this.plans = {};
    this.ruler = null;
  }

  /** Reads mission, fence and rally points of a vehicle, once and after its mission has changed. */
  async loadPlans(vehicle: Vehicle, again = false): Promise<void> {
    const total = vehicle.state.mission?.total ?? null;
    const known = this.planTotals.get(vehicle.system);
    if (!again && known !== undefined && (total === null || known === total)) return;
    this.planTotals.set(vehicle.system, total);
    const { capabilities } = vehicle;
    const mission = await items(vehicle, 'mission', capabilities.mission);
    const fence = await items(vehicle, 'fence', capabilities.fence);
    const rally = await items(vehicle, 'rally', capabilities.rally);
    const loaded = { mission, fence: fenceShapes(fence), rally: rallyPlaces(rally) };
    this.plans = { ...this.plans, [vehicle.system]: loaded };
  }

  plansOf(system: number): VehiclePlans {
    return this.plans[system] ?? NO_PLANS;
  }

  /** Returns the way of a vehicle's mission; it begins at home, which may become known later than the mission. */
  pathOf(vehicle: Vehicle): MissionPath {
    const { mission } = this.plansOf(vehicle.system);
    const { home } = vehicle.state;
    const known = this.paths.get(vehicle.system);
    if (known !== undefined && known.mission === mission && known.home === home) return known.path;
    const path = missionPath(mission, home);
    this.paths.set(vehicle.system, { mission, home, path });
    return path;
  }
}

async function items(vehicle: Vehicle, kind: PlanKind, capability: boolean | null): Promise<readonly PlanItem[]> {
  if (capability === false) return [];
  try {
    return (await vehicle.downloadPlan(kind)).items;
  } catch {
    // The map is no place to complain that a vehicle has no such plan; the plan view tells the reason.
    return [];
  }
}

export const fly = new FlyState();
