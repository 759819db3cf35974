/** Layers of the fly view's map: they read the store, so that each change of it paints the map once. */
import { t } from '$lib/i18n';
import { paintFence, paintHome, paintMission, paintRally, paintRuler, paintTarget } from '$lib/map/planLayer';
import type { Layer } from '$lib/map/drawing';
import { distance } from '$lib/map/geometry';
import { paintTraffic } from '$lib/map/traffic';
import { type MapVehicle, paintVehicles } from '$lib/map/vehicleLayer';
import { fleet } from '$lib/store/fleet.svelte';
import { format } from '$lib/units/units';
import { currentItemNumber } from '$lib/vehicle/missionItem';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { fly, type Ruler } from './fly.svelte';
import type { Spot } from './formation';
import { bearingText } from './reading';

/** Homes and missions of so many vehicles are shown; of larger fleets only those of the selected vehicle. */
const MAX_WITH_PLANS = 12;

/** Returns a vehicle as the map shows it, or null while its position is not known. */
export function mapVehicle(vehicle: Vehicle, isSelected: boolean): MapVehicle | null {
  const { system, position, velocity, type, heading, armed, alive } = vehicle.state;
  if (position === null) return null;
  const altitude = position.relativeAltitude;
  return {
    system,
    type,
    heading,
    velocity,
    isArmed: armed === true,
    isAlive: alive,
    isSelected,
    latitude: position.latitude,
    longitude: position.longitude,
    caption: altitude === null ? [String(system)] : [`${system} · `, format(altitude, 'altitude', 0)],
    trackEnd: fly.trackEnd(system),
  };
}

/** Returns all vehicles whose positions are known. */
export function mapVehicles(): MapVehicle[] {
  const selected = new Set(fly.targets.map((vehicle) => vehicle.system));
  return fleet.vehicles.map((each) => mapVehicle(each, selected.has(each.system))).filter((each) => each !== null);
}

/** Returns the vehicles whose homes and missions are drawn. */
export function withPlans(): readonly Vehicle[] {
  const few = fleet.vehicles.length <= MAX_WITH_PLANS;
  return few ? fleet.vehicles : fleet.vehicles.filter(({ system }) => system === fleet.selectedSystem);
}

const plans: Layer = (drawing) => {
  for (const vehicle of withPlans()) {
    const isSelected = vehicle.system === fleet.selectedSystem;
    const { mission, fence, rally } = fly.plansOf(vehicle.system);
    if (isSelected) {
      paintFence(drawing, fence);
      paintRally(drawing, rally);
    }
    if (mission.length === 0) continue;
    paintMission(drawing, fly.pathOf(vehicle), {
      isFaint: !isSelected,
      current: currentItemNumber(vehicle.state),
    });
  }
};

const homes: Layer = (drawing) => {
  const shown = withPlans();
  for (const { system, state } of shown) {
    if (state.home !== null) paintHome(drawing, state.home, shown.length > 1 ? String(system) : '');
  }
};

const traffic: Layer = (drawing) => {
  paintTraffic(drawing, fly.traffic, fleet.selected?.state.position?.altitude ?? null);
};

const target: Layer = (drawing) => {
  if (fly.target === null) return;
  const { spots, radius } = fly.target;
  const places = new Map<string, Spot[]>();
  for (const spot of spots) {
    const key = `${spot.place.latitude},${spot.place.longitude}`;
    places.set(key, [...(places.get(key) ?? []), spot]);
  }
  for (const at of places.values()) {
    paintTarget(drawing, at[0]!.place, at.map(({ system }) => system).join(', '), radius);
  }
};

const ruler: Layer = (drawing) => {
  if (fly.ruler !== null) paintRuler(drawing, fly.ruler.from, fly.ruler.to, measuredText(fly.ruler));
};

/** Returns distance and bearing of a ruler, as the map shows them. */
export function measuredText({ from, to }: Ruler): string {
  if (to === null) return '';
  return t('fly.measuredLabel', {
    distance: format(distance(from, to), 'distance') ?? '',
    bearing: bearingText(from, to),
  });
}

const vehicles: Layer = (drawing) => paintVehicles(drawing, mapVehicles());

export const LAYERS: readonly Layer[] = [plans, homes, traffic, ruler, target, vehicles];
