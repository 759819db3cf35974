/** Places ↔ pixels of the map as it is shown now. The map is never tilted, so this is a turned, scaled Mercator. */
import { type Bounds, mercatorLatitude, mercatorX, mercatorY, type Place, wrapLongitude } from './geometry';

/** Pixels of the whole world at zoom 0. */
const TILE_SIZE = 512;
const EQUATOR = 40_075_016.686;

export interface View {
  readonly latitude: number;
  readonly longitude: number;
  readonly zoom: number;
  /** Direction that is up on the screen, degrees. */
  readonly bearing: number;
  /** CSS pixels. */
  readonly width: number;
  readonly height: number;
}

export interface Point {
  readonly x: number;
  readonly y: number;
}

export class Projection {
  readonly view: View;
  private readonly scale: number;
  private readonly sine: number;
  private readonly cosine: number;
  private readonly centreX: number;
  private readonly centreY: number;

  constructor(view: View) {
    this.view = view;
    this.scale = TILE_SIZE * 2 ** view.zoom;
    const angle = (-view.bearing * Math.PI) / 180;
    this.sine = Math.sin(angle);
    this.cosine = Math.cos(angle);
    this.centreX = mercatorX(view.longitude);
    this.centreY = mercatorY(view.latitude);
  }

  /** Return the pixel of a place: the one of the nearest copy of the world. */
  toPixel(latitude: number, longitude: number): Point {
    let east = mercatorX(longitude) - this.centreX;
    east -= Math.round(east);
    const right = east * this.scale;
    const down = (mercatorY(latitude) - this.centreY) * this.scale;
    return {
      x: this.view.width / 2 + right * this.cosine - down * this.sine,
      y: this.view.height / 2 + right * this.sine + down * this.cosine,
    };
  }

  /** Return the place below a pixel. */
  toPlace(x: number, y: number): Place {
    const [right, down] = [x - this.view.width / 2, y - this.view.height / 2];
    const east = (right * this.cosine + down * this.sine) / this.scale;
    const south = (down * this.cosine - right * this.sine) / this.scale;
    return {
      latitude: mercatorLatitude(Math.max(0, Math.min(1, this.centreY + south))),
      longitude: wrapLongitude((this.centreX + east) * 360 - 180),
    };
  }

  /** Return the bounds of what is shown; `east` is beyond 180 across the date line. */
  bounds(): Bounds {
    const { width, height, longitude } = this.view;
    const corners = [
      [0, 0],
      [width, 0],
      [0, height],
      [width, height],
    ].map(([x, y]) => this.toPlace(x!, y!));
    const latitudes = corners.map((corner) => corner.latitude);
    const half = Math.min(180, ((Math.abs(width * this.cosine) + Math.abs(height * this.sine)) / this.scale) * 180);
    return {
      south: Math.min(...latitudes),
      north: Math.max(...latitudes),
      west: longitude - half,
      east: longitude + half,
    };
  }

  /** Return the pixels of a metre at a latitude. */
  pixelsPerMetre(latitude: number): number {
    return this.scale / (EQUATOR * Math.cos((latitude * Math.PI) / 180));
  }

  isVisible({ x, y }: Point, margin = 0): boolean {
    return x >= -margin && y >= -margin && x <= this.view.width + margin && y <= this.view.height + margin;
  }
}
