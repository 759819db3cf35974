/**
 * Small pictures that are painted once and copied from then on.
 *
 * Texts with halos and outlines of symbols are slow to paint; a hundred vehicles would take longer than a frame.
 */

interface Sprite {
  readonly canvas: HTMLCanvasElement;
  readonly width: number;
  readonly height: number;
}

const MAX_SPRITES = 800;
const sprites = new Map<string, Sprite>();

/**
 * Copies a picture to a place, in the present transformation.
 *
 * @param key - Everything that the picture depends on.
 * @param width - Width and height in CSS pixels; the origin of `paint` is the middle.
 */
export function stamp(
  context: CanvasRenderingContext2D, key: string, width: number, height: number, paint: (context: CanvasRenderingContext2D) => void,
): void {
  const scale = window.devicePixelRatio || 1;
  const name = `${key}|${scale}`;
  const sprite = sprites.get(name) ?? painted(width, height, scale, paint);
  // Moved to the end: the oldest sprites are dropped first.
  sprites.delete(name);
  sprites.set(name, sprite);
  if (sprites.size > MAX_SPRITES) sprites.delete(sprites.keys().next().value!);
  context.drawImage(sprite.canvas, -sprite.width / 2, -sprite.height / 2, sprite.width, sprite.height);
}

function painted(width: number, height: number, scale: number, paint: (context: CanvasRenderingContext2D) => void): Sprite {
  const canvas = document.createElement('canvas');
  canvas.width = Math.ceil(width * scale);
  canvas.height = Math.ceil(height * scale);
  const context = canvas.getContext('2d');
  if (context !== null) {
    context.setTransform(scale, 0, 0, scale, canvas.width / 2, canvas.height / 2);
    paint(context);
  }
  return { canvas, width: canvas.width / scale, height: canvas.height / scale };
}
