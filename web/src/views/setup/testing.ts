/** A vehicle without a link, for tests of the set-up. */

import type { Vehicle } from '$lib/vehicle/Vehicle';

/** Returns a vehicle of which a test states what it needs; it listens to nothing. */
export function vehicle(values: object): Vehicle {
  const nothing = (): (() => void) => () => undefined;
  const state = { firmware: 'px4', alive: true };
  return {
    system: 1,
    state,
    onMessage: nothing,
    onState: nothing,
    onStatusText: nothing,
    ...values,
  } as unknown as Vehicle;
}

/** Returns a promise with the function that resolves it. */
export function settled<Result>(): { promise: Promise<Result>; resolve: (result: Result) => void } {
  let resolve: (result: Result) => void = () => undefined;
  const promise = new Promise<Result>((done) => (resolve = done));
  return { promise, resolve };
}
