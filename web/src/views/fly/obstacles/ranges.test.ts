import { MavFrame, MavSensorOrientation } from '$generated';
import { describe, expect, it } from 'vitest';

import { Decoder, Encoder } from '$lib/decoder/Decoder';

import { nearestOf, rangeOf, sectorPath, surroundingsOf } from './ranges';

const encoder = new Encoder(1, 1);
const decode = (name: string, fields: Parameters<Encoder['build']>[1]): ReturnType<Decoder['push']>[number] =>
  new Decoder().push(encoder.build(name, fields))[0]!;

describe('distances', () => {
  it('of single sensors have a direction, and are null beyond their reach', () => {
    const sensor = (orientation: number, current_distance: number): ReturnType<typeof rangeOf> =>
      rangeOf(decode('DISTANCE_SENSOR', { id: 3, orientation, current_distance, max_distance: 4000 }));
    expect(sensor(MavSensorOrientation.PITCH_270, 150)).toEqual({
      id: 3,
      direction: 'down',
      bearing: null,
      distance: 1.5,
      reach: 40,
    });
    expect(sensor(MavSensorOrientation.YAW_90, 4000)).toMatchObject({
      direction: 'right',
      bearing: 90,
      distance: null,
    });
  });

  it('around the vehicle are relative to the nose in both frames', () => {
    const distances = Array.from({ length: 72 }, (_, index) => (index === 1 ? 500 : 65535));
    const fields = { distances, increment: 10, max_distance: 3000, angle_offset: 5 };
    const body = surroundingsOf(decode('OBSTACLE_DISTANCE', { ...fields, frame: MavFrame.BODY_FRD }), 90);
    expect(body.sectors).toHaveLength(36);
    expect(body.sectors[1]).toEqual({ bearing: 15, width: 10, distance: 5 });
    const north = surroundingsOf(decode('OBSTACLE_DISTANCE', { ...fields, frame: MavFrame.GLOBAL }), 90);
    expect(north.sectors[1]).toEqual({ bearing: 285, width: 10, distance: 5 });
    expect([nearestOf([], body), nearestOf([], null)]).toEqual([5, null]);
  });

  it('count from the right to the left with a negative increment', () => {
    const fields = { distances: [100, 200], increment_f: -5, max_distance: 3000, frame: MavFrame.BODY_FRD };
    expect(surroundingsOf(decode('OBSTACLE_DISTANCE', fields), 0).sectors[1]).toMatchObject({ bearing: 355 });
  });

  it('are drawn with the nose at the top', () => {
    expect(sectorPath({ bearing: 0, width: 90, distance: 1 }, 0.5, 1)).toMatch(
      /^M-0\.3536 -0\.3536L-0\.7071 -0\.7071A/,
    );
  });
});
