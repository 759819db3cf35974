/** Plans that the station divides among vehicles (`/api/surveys`, `/api/searches`): the part of each vehicle. */

import { fleet } from '$lib/store/fleet.svelte';

import type { PlanItem, Vehicle } from './Vehicle';

export interface Share {
  readonly system: number | null;
  readonly altitude_m: number;
  readonly length_m: number;
  /** The tracks with the straight ways between them. */
  readonly way_m: number;
  /** Null without a speed. */
  readonly duration_s: number;
  readonly legs: readonly (readonly (readonly [number, number])[])[];
  readonly items: readonly PlanItem[];
}

/** Uploads each part to its vehicle as its mission, and returns the vehicles; no vehicle starts it. */
export async function uploadShares(shares: readonly Share[]): Promise<readonly Vehicle[]> {
  const vehicles: Vehicle[] = [];
  for (const { system, items } of shares) {
    const vehicle = system === null ? null : fleet.vehicle(system);
    if (!vehicle) continue;
    await vehicle.uploadPlan('mission', { items, home: null });
    vehicles.push(vehicle);
  }
  return vehicles;
}
