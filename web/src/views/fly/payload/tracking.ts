/** The part of a camera's picture that is tracked, by what a pointer did over it. */

export interface Point {
  /** Shares of the width and the height. */
  readonly x: number;
  readonly y: number;
}

export type Track =
  | { readonly kind: 'point'; readonly x: number; readonly y: number }
  | {
      readonly kind: 'rectangle';
      readonly left: number;
      readonly top: number;
      readonly right: number;
      readonly bottom: number;
    };

/** A smaller movement is a click. */
const MIN_DRAG = 0.03;

const inside = (value: number): number => Math.min(1, Math.max(0, value));

/** Returns the point of a click, or the rectangle of a drag where a camera tracks rectangles. */
export function areaOf(start: Point, end: Point, hasRectangles: boolean): Track {
  const [left, right] = [inside(Math.min(start.x, end.x)), inside(Math.max(start.x, end.x))];
  const [top, bottom] = [inside(Math.min(start.y, end.y)), inside(Math.max(start.y, end.y))];
  const isDrag = right - left >= MIN_DRAG && bottom - top >= MIN_DRAG;
  if (hasRectangles && isDrag) return { kind: 'rectangle', left, top, right, bottom };
  return { kind: 'point', x: inside(start.x), y: inside(start.y) };
}
