/** The ticks of the check list for each vehicle, and own items for each vehicle type. */

import { Persisted } from '$lib/store/settings.svelte';
import type { VehicleState } from '$lib/vehicle/Vehicle';

import { automaticChecks, manualChecks } from './checks';

class Preflight {
  /** Items that were ticked, by system id; they hold for one flight. */
  private ticked: Readonly<Record<number, ReadonlySet<string>>> = $state.raw({});
  /** Vehicles that were armed after their items were ticked. */
  private readonly flown = new Set<number>();
  /** Items that the pilot added, by vehicle type. */
  readonly own = new Persisted<Readonly<Record<string, readonly string[]>>>('fly.checkList', {});

  isTicked(system: number, item: string): boolean {
    return this.ticked[system]?.has(item) ?? false;
  }

  hasTicks(system: number): boolean {
    return (this.ticked[system]?.size ?? 0) > 0;
  }

  tick(system: number, item: string): void {
    const items = new Set(this.ticked[system] ?? []);
    if (!items.delete(item)) items.add(item);
    this.ticked = { ...this.ticked, [system]: items };
  }

  reset(system: number): void {
    this.ticked = { ...this.ticked, [system]: new Set() };
  }

  /** Forgets the ticks after a flight: each flight has its own checks. */
  follow(state: VehicleState): void {
    if (state.armed === true) this.flown.add(state.system);
    else if (state.armed === false && this.flown.delete(state.system)) this.reset(state.system);
  }

  ownItems({ type }: VehicleState): readonly string[] {
    return this.own.value[type] ?? [];
  }

  setOwnItems({ type }: VehicleState, items: readonly string[]): void {
    this.own.value = { ...this.own.value, [type]: items };
  }

  /** Returns how many items are good or ticked, of how many; those that the vehicle does not report do not count. */
  progress(state: VehicleState): { done: number; all: number } {
    const automatic = automaticChecks(state).filter((check) => check.state !== 'unknown');
    const manual = [...manualChecks(state.type), ...this.ownItems(state)];
    const good = automatic.filter((check) => check.state === 'ok').length;
    const ticked = manual.filter((item) => this.isTicked(state.system, item)).length;
    return { done: good + ticked, all: automatic.length + manual.length };
  }
}

export const preflight = new Preflight();
