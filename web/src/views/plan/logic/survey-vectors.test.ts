/** The plans of surveys that Python's planner writes (`conformance/survey`). */

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { describe, expect, it } from 'vitest';

import { toMetres } from '$lib/map/localFrame';

import { bestBearing } from './areas';
import { corridorLanes } from './corridor';
import type { Point } from './geo';
import { surveyLanes } from './survey';

type Pair = readonly [number, number];
interface Vector {
  readonly name: string;
  readonly path: string;
  readonly request: {
    readonly outline?: readonly Pair[];
    readonly route?: readonly Pair[];
    readonly width?: number;
    readonly spacing?: number;
    readonly bearing?: number;
    readonly crosshatch?: boolean;
    readonly turn_radius?: number;
    readonly obstacles?: readonly (readonly Pair[])[];
    readonly vehicles?: readonly object[];
  };
  readonly plan: {
    readonly spacing_m: number;
    readonly bearing_deg: number | null;
    readonly shares: readonly { readonly legs: readonly (readonly [Pair, Pair])[] }[];
  };
}

const folder = join(import.meta.dirname, '../../../../../conformance/survey');
const vectors = readdirSync(folder).map((name) => JSON.parse(readFileSync(join(folder, name), 'ascii')) as Vector);
/** The page draws surveys of one vehicle; the station divides them. */
const own = vectors.filter(({ path, request }) => path === '/api/surveys' && request.vehicles === undefined);
const point = ([latitude, longitude]: Pair): Point => ({ latitude, longitude });

function legsOf({ request, plan }: Vector): (readonly [Point, Point])[] {
  const lanes = request.route
    ? corridorLanes(request.route.map(point), { width: request.width!, spacing: plan.spacing_m })
    : surveyLanes(request.outline!.map(point), {
        spacing: plan.spacing_m,
        angle:
          request.bearing ??
          bestBearing(request.outline!.map((each) => toMetres(point(request.outline![0]!), point(each)))),
        crosshatch: request.crosshatch === true,
        turnRadius: request.turn_radius ?? 0,
        obstacles: (request.obstacles ?? []).map((each) => each.map(point)),
      });
  return lanes.flatMap((lane) => lane.slice(1).map((end, index) => [lane[index]!, end] as const));
}

describe('surveys of the page', () => {
  it('are all of one vehicle', () => expect(own.length).toBeGreaterThanOrEqual(11));

  it.each(own.map((vector) => [vector.name, vector] as const))('%s has the legs of the vector', (_, vector) => {
    const expected = vector.plan.shares[0]!.legs.map(([start, end]) => [point(start), point(end)] as const);
    const legs = legsOf(vector);
    expect(legs).toHaveLength(expected.length);
    legs.forEach((leg, index) => {
      for (const end of [0, 1] as const) {
        expect(Math.hypot(...toMetres(expected[index]![end], leg[end]))).toBeLessThan(0.05);
      }
    });
  });
});
