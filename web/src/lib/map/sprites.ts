/**
 * Small pictures that are painted once and copied from then on.
 *
 * Texts with halos and outlines of symbols are slow to paint; a hundred vehicles would take longer than a frame.
 */

export interface Sprite {
  readonly picture: CanvasImageSource;
  /** In CSS pixels. */
  readonly width: number;
  readonly height: number;
}

type Paint = (context: CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D) => void;

const MAX_SPRITES = 800;
const sprites = new Map<string, Sprite>();

/**
 * Returns a picture, painted now if it is not there yet.
 *
 * @param key - Everything that the picture depends on.
 * @param size - Width and height in CSS pixels; the origin of `paint` is the middle.
 */
export function spriteOf(key: string, size: () => readonly [width: number, height: number], paint: Paint): Sprite {
  const scale = window.devicePixelRatio || 1;
  const name = `${key}|${scale}`;
  const known = sprites.get(name);
  if (known !== undefined) return known;
  if (sprites.size >= MAX_SPRITES) dropOldest();
  const sprite = painted(...size(), scale, paint);
  sprites.set(name, sprite);
  return sprite;
}

/** Copies a picture with its middle at a place of the present transformation. */
export function stamp(context: CanvasRenderingContext2D, { picture, width, height }: Sprite, x = 0, y = 0): void {
  context.drawImage(picture, x - width / 2, y - height / 2, width, height);
}

function dropOldest(): void {
  const [oldest, sprite] = sprites.entries().next().value!;
  sprites.delete(oldest);
  if (sprite.picture instanceof ImageBitmap) sprite.picture.close();
}

function painted(width: number, height: number, scale: number, paint: Paint): Sprite {
  // With an even number of pixels the middle is between two of them: a copy at whole pixels is sharp, and fast.
  const even = (length: number): number => 2 * Math.ceil((length * scale) / 2);
  const canvas = new OffscreenCanvas(even(width), even(height));
  const context = canvas.getContext('2d');
  const size = { width: canvas.width / scale, height: canvas.height / scale };
  if (context === null) return { picture: canvas, ...size };
  context.setTransform(scale, 0, 0, scale, canvas.width / 2, canvas.height / 2);
  paint(context);
  // A canvas would be copied each time it is drawn.
  return { picture: canvas.transferToImageBitmap(), ...size };
}
