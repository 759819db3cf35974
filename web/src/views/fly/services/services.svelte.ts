/** The reports of the selected vehicle about RTK and Remote ID. */

import type { Vehicle } from '$lib/vehicle/Vehicle';

import { type Baseline, baselineOf, type Fix, fixOf, type RemoteId, remoteIdOf } from './reports';

class Services {
  fixes: readonly (Fix | undefined)[] = $state.raw([]);
  baseline: Baseline | null = $state.raw(null);
  remoteId: RemoteId | null = $state.raw(null);
  readonly isPresent = $derived(this.remoteId !== null || this.baseline !== null || this.fixes.some((fix) => fix));

  /** Shows the reports of a vehicle from now on; returns the function that ends it. */
  follow(vehicle: Vehicle | null): () => void {
    [this.fixes, this.baseline, this.remoteId] = [[], null, null];
    if (vehicle === null) return () => undefined;
    const removers = [
      ...['GPS_RAW_INT', 'GPS2_RAW'].map((name, index) =>
        vehicle.onMessage(name, ({ fields, component }) => {
          if (component !== vehicle.state.component) return;
          const fixes = [...this.fixes];
          fixes[index] = fixOf(fields);
          this.fixes = fixes;
        }),
      ),
      ...['GPS_RTK', 'GPS2_RTK'].map((name) =>
        vehicle.onMessage(name, ({ fields }) => (this.baseline = baselineOf(fields))),
      ),
      vehicle.onMessage('OPEN_DRONE_ID_ARM_STATUS', ({ fields }) => (this.remoteId = remoteIdOf(fields))),
    ];
    return () => removers.forEach((remove) => remove());
  }
}

export const services = new Services();
