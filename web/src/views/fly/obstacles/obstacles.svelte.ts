/** The distances that the selected vehicle measured last. */

import type { DecodedMessage } from '$lib/decoder/Decoder';
import { t } from '$lib/i18n';
import { format } from '$lib/units/units';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { nearestOf, type Range, rangeOf, type Surroundings, surroundingsOf } from './ranges';

/** Times in ms: between two pictures, and until a measurement is too old to be shown. */
const INTERVAL = 200;
const LIFETIME = 3000;
const MAX_SENSORS = 16;

class Obstacles {
  ranges: readonly Range[] = $state.raw([]);
  around: Surroundings | null = $state.raw(null);
  readonly isPresent = $derived(this.ranges.length > 0 || this.around !== null);
  readonly nearest = $derived(nearestOf(this.ranges, this.around));
  /** The nearest obstacle in words. */
  readonly note = $derived(
    this.nearest === null ? '' : t('payload.nearest', { distance: format(this.nearest, 'distance', 1) ?? '' }),
  );

  /** Shows the distances of a vehicle from now on; returns the function that ends it. */
  follow(vehicle: Vehicle | null): () => void {
    this.ranges = [];
    this.around = null;
    if (vehicle === null) return () => undefined;
    const sensors = new Map<string, DecodedMessage>();
    let circle: DecodedMessage | null = null;
    const removers = [
      vehicle.onMessage('DISTANCE_SENSOR', (message) => {
        const key = `${message.component}/${Number(message.fields.id)}/${Number(message.fields.orientation)}`;
        if (sensors.size < MAX_SENSORS || sensors.has(key)) sensors.set(key, message);
      }),
      vehicle.onMessage('OBSTACLE_DISTANCE', (message) => {
        circle = message;
      }),
    ];
    const timer = setInterval(() => {
      const now = Date.now();
      for (const [key, { time }] of sensors) if (now - time > LIFETIME) sensors.delete(key);
      if (circle !== null && now - circle.time > LIFETIME) circle = null;
      if (sensors.size > 0 || this.ranges.length > 0) this.ranges = [...sensors.values()].map(rangeOf);
      this.around = circle === null ? null : surroundingsOf(circle, vehicle.state.heading ?? 0);
    }, INTERVAL);
    return () => {
      clearInterval(timer);
      for (const remove of removers) remove();
    };
  }
}

export const obstacles = new Obstacles();
