/** Heights of the terrain: .hgt files that the user opens, and tiles whose colours are heights. */

import type { Point } from './geo';

/** Returns heights in metres above mean sea level, in the order of the points; null: not known. */
export type ElevationSource = (points: readonly Point[]) => Promise<(number | null)[]>;

export interface HgtFile {
  /** The south-western corner in whole degrees. */
  readonly south: number;
  readonly west: number;
  /** Points along an edge. */
  readonly edge: number;
  readonly data: DataView;
}

const HGT_NAME = /([NS])(\d{2})([EW])(\d{3})\.hgt$/i;
const HGT_UNKNOWN = -32_768;
const HGT_EDGES = [1201, 3601];

/** Reads a file such as N47E008.hgt: rows of big-endian 16-bit heights from north to south; throws if it is none. */
export function readHgt(name: string, content: ArrayBuffer): HgtFile {
  const match = HGT_NAME.exec(name);
  if (!match) throw new Error(`${name}: the name must give the south-western corner, such as N47E008.hgt`);
  const edge = HGT_EDGES.find((each) => each * each * 2 === content.byteLength);
  if (!edge) throw new Error(`${name}: ${content.byteLength} bytes are not the size of an .hgt file`);
  const south = Number(match[2]) * (match[1]!.toUpperCase() === 'S' ? -1 : 1);
  const west = Number(match[4]) * (match[3]!.toUpperCase() === 'W' ? -1 : 1);
  return { south, west, edge, data: new DataView(content) };
}

/** Returns the height at a point, between the four points around it; null outside of the file. */
export function hgtHeight(file: HgtFile, at: Point): number | null {
  const steps = file.edge - 1;
  const [row, column] = [(file.south + 1 - at.latitude) * steps, (at.longitude - file.west) * steps];
  if (!(row >= 0 && row <= steps && column >= 0 && column <= steps)) return null;
  const height = (y: number, x: number): number => file.data.getInt16(2 * (y * file.edge + x));
  const [top, left] = [Math.min(Math.floor(row), steps - 1), Math.min(Math.floor(column), steps - 1)];
  const around = [height(top, left), height(top, left + 1), height(top + 1, left), height(top + 1, left + 1)];
  if (around.includes(HGT_UNKNOWN)) return null;
  return bilinear(around, column - left, row - top);
}

function bilinear([a, b, c, d]: number[], x: number, y: number): number {
  return (a! * (1 - x) + b! * x) * (1 - y) + (c! * (1 - x) + d! * x) * y;
}

/** Returns a source of the heights of some files. */
export function hgtSource(files: readonly HgtFile[]): ElevationSource {
  const find = (point: Point): number | null => {
    for (const file of files) {
      const height = hgtHeight(file, point);
      if (height !== null) return height;
    }
    return null;
  };
  return async (points) => points.map(find);
}

export type TileEncoding = 'terrarium' | 'mapbox';

/** Returns the height in metres that the colour of a pixel stands for. */
export function heightOfColour(encoding: TileEncoding, red: number, green: number, blue: number): number {
  if (encoding === 'terrarium') return red * 256 + green + blue / 256 - 32_768;
  return (red * 65_536 + green * 256 + blue) / 10 - 10_000;
}

export interface TilePlace {
  readonly x: number;
  readonly y: number;
  /** Pixels in the tile. */
  readonly column: number;
  readonly row: number;
}

/** Returns the tile and the pixel of a point in Web Mercator. */
export function tilePlace(at: Point, zoom: number, size: number): TilePlace {
  const count = 2 ** zoom;
  const sine = Math.sin((at.latitude * Math.PI) / 180);
  const x = ((at.longitude + 180) / 360) * count;
  const y = (0.5 - Math.log((1 + sine) / (1 - sine)) / (4 * Math.PI)) * count;
  const [tileX, tileY] = [Math.min(count - 1, Math.floor(x)), Math.max(0, Math.min(count - 1, Math.floor(y)))];
  const pixel = (part: number): number => Math.max(0, Math.min(size - 1, Math.floor(part * size)));
  return { x: tileX, y: tileY, column: pixel(x - tileX), row: pixel(y - tileY) };
}

/** Red, green, blue and alpha of each pixel. */
export interface Picture {
  readonly width: number;
  readonly data: ArrayLike<number>;
}

const TILE_ZOOM = 13;
/** Metres below which a colour stands for no height, as transparent pixels have. */
const NO_HEIGHT = -9000;

/**
 * Returns a source of tiles with an address such as `https://…/{z}/{x}/{y}.png`.
 *
 * A tile that cannot be loaded has unknown heights.
 */
export function tileSource(
  template: string,
  encoding: TileEncoding,
  load: (url: string) => Promise<Picture> = loadPicture,
  zoom = TILE_ZOOM,
): ElevationSource {
  const tiles = new Map<string, Promise<Picture | null>>();
  const tile = (x: number, y: number): Promise<Picture | null> => {
    const url = template.replace('{z}', String(zoom)).replace('{x}', String(x)).replace('{y}', String(y));
    const found = tiles.get(url) ?? load(url).catch(() => null);
    tiles.set(url, found);
    return found;
  };
  return (points) =>
    Promise.all(
      points.map(async (point) => {
        const { x, y } = tilePlace(point, zoom, 1);
        const picture = await tile(x, y);
        if (!picture) return null;
        const { column, row } = tilePlace(point, zoom, picture.width);
        const at = 4 * (row * picture.width + column);
        const height = heightOfColour(encoding, picture.data[at]!, picture.data[at + 1]!, picture.data[at + 2]!);
        return height > NO_HEIGHT ? height : null;
      }),
    );
}

export async function loadPicture(url: string): Promise<Picture> {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  // The colours are numbers: without this the browser would fit them to the screen.
  const bitmap = await createImageBitmap(await response.blob(), {
    colorSpaceConversion: 'none',
    premultiplyAlpha: 'none',
  });
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
  if (!context) throw new Error('no canvas');
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height);
}
