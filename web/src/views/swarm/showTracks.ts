/** The tracks of a show: places that are equally far apart in time, and the picture of their heights. */
import type { Slot } from './slots';

/** Returns the place at a share of the time from 0 to 1. */
export function placeAt(places: readonly Slot[], share: number): Slot {
  const last = places.length - 1;
  const at = Math.min(Math.max(Number.isFinite(share) ? share : 0, 0), 1) * last;
  const index = Math.min(Math.floor(at), Math.max(last - 1, 0));
  const from = places[index] ?? [0, 0, 0];
  const to = places[index + 1] ?? from;
  const part = at - index;
  return [0, 1, 2].map((axis) => from[axis]! + part * (to[axis]! - from[axis]!)) as unknown as Slot;
}

/** The box of the side view: metres left and right of the origin, and up. */
export interface SideBox {
  readonly left: number;
  readonly right: number;
  readonly top: number;
}

/** Returns the smallest box, with a margin, in which all vehicles stay, seen along the x axis. */
export function sideBox(tracks: readonly { readonly places: readonly Slot[] }[]): SideBox {
  const box = { left: -5, right: 5, top: 5 };
  for (const { places } of tracks) {
    for (const [, right, up] of places) {
      box.left = Math.min(box.left, right - 2);
      box.right = Math.max(box.right, right + 2);
      box.top = Math.max(box.top, up + 2);
    }
  }
  return box;
}
