/** Facts about the selected vehicle that the plan depends on. */

import { fleet } from '$lib/store/fleet.svelte';
import { currentItemNumber } from '$lib/vehicle/missionItem';

import type { Point } from './logic/geo';
import type { Item, Place, Plan } from './logic/model';

/** Returns its position, rounded to some hundred metres, so that its motion does not check the plan again and again. */
export function placeOfVehicle(): Point | null {
  const at = fleet.selected?.state.position ?? null;
  return at && { latitude: Math.round(at.latitude * 200) / 200, longitude: Math.round(at.longitude * 200) / 200 };
}

/** Returns its home or else its position, if it has sent one. */
export function knownHome(): Place | null {
  const home = fleet.selected?.state.home ?? fleet.selected?.state.position ?? null;
  return home && { latitude: home.latitude, longitude: home.longitude, altitude: home.altitude ?? 0 };
}

/** Returns MAV_AUTOPILOT of the vehicle, or that of the plan without one. */
export function firmwareFor(plan: Plan): number {
  return fleet.selected?.state.autopilot ?? plan.firmware;
}

/** Returns a plan for the kind of the vehicle, which speeds depend on. */
export function forVehicle(plan: Plan): Plan {
  const vehicle = fleet.selected?.state;
  return vehicle ? { ...plan, firmware: vehicle.autopilot, vehicleType: vehicle.mavType } : plan;
}

/**
 * Returns the number of the item that the vehicle flies to, from 1; null if its mission is another one than the plan's.
 *
 * @param held - The items that vehicles have, by system id and kind.
 */
export function currentItemOf(plan: Plan, held: Readonly<Record<string, readonly Item[]>>): number | null {
  const vehicle = fleet.selected;
  const items = vehicle && held[`${vehicle.system} mission`];
  const isShown = items && (items === plan.mission || JSON.stringify(items) === JSON.stringify(plan.mission));
  return isShown ? currentItemNumber(vehicle.state) : null;
}
