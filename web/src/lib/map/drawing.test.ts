import { beforeEach, describe, expect, it, vi } from 'vitest';

import { label, type Drawing } from './drawing';
import { DARK } from './palette';
import type { Projection } from './projection';

/** Pixels of a letter. */
const LETTER = 7;

/** Replaces the canvases, which Node has not; returns the sizes of the pictures that are painted. */
function pictures(): readonly (readonly [width: number, height: number])[] {
  const painted: [number, number][] = [];
  class Picture {
    constructor(
      readonly width: number,
      readonly height: number,
    ) {
      painted.push([width, height]);
    }

    getContext(): null {
      return null;
    }
  }
  vi.stubGlobal('OffscreenCanvas', Picture);
  vi.stubGlobal('window', { devicePixelRatio: 1 });
  return painted;
}

function drawing(): { readonly drawing: Drawing; readonly drawImage: ReturnType<typeof vi.fn> } {
  const drawImage = vi.fn();
  const context = { drawImage, measureText: (text: string) => ({ width: text.length * LETTER }) };
  const [view, canvas] = [{} as Projection, context as unknown as CanvasRenderingContext2D];
  return { drawing: { context: canvas, projection: view, palette: DARK }, drawImage };
}

describe('label', () => {
  beforeEach(() => void vi.unstubAllGlobals());

  it('paints a part once, however many texts have it', () => {
    const painted = pictures();
    const { drawing: map, drawImage } = drawing();
    for (const number of [1, 2, 3]) label(map, [`${number} · `, '30 m'], { x: 100, y: 50 });
    expect(drawImage).toHaveBeenCalledTimes(6);
    expect(painted).toHaveLength(4);
  });

  it('writes parts where the whole text would be, at whole pixels', () => {
    pictures();
    const { drawing: map, drawImage } = drawing();
    label(map, ['12 · ', '345 m'], { x: 100.3, y: 50.4 });
    const [left, right] = drawImage.mock.calls.map(([, x, y, width]) => [x as number, y as number, width as number]);
    const margin = 5;
    expect(Math.abs(left![0]! + margin - (100 - 5 * LETTER))).toBeLessThanOrEqual(1);
    expect(right![0]!).toBe(left![0]! + 5 * LETTER + 1);
    expect([...left!, ...right!].every(Number.isInteger)).toBe(true);
  });
});
