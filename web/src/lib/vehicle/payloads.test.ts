import { CameraCapFlags, GimbalManagerCapFlags } from '$generated';
import { describe, expect, it } from 'vitest';

import { ApiClient } from '$lib/api/client';

import { type GimbalView, hasFeature, Payloads, rangesOf } from './payloads';

const camera = (capabilities: number, definition_uri = ''): Parameters<typeof hasFeature>[0] => ({
  information: { vendor: '', model: '', capabilities, definition_uri },
});

describe('cameras', () => {
  it('have the features of their flags', () => {
    const zooms = camera(CameraCapFlags.HAS_BASIC_ZOOM | CameraCapFlags.CAPTURE_IMAGE);
    expect(hasFeature(zooms, 'zoom')).toBe(true);
    expect(hasFeature(zooms, 'focus')).toBe(false);
    expect(hasFeature(zooms, 'settings')).toBe(false);
    expect(hasFeature(camera(0, 'mftp://camera.xml'), 'settings')).toBe(true);
  });

  it('may have all features until they have told their flags', () => {
    expect(hasFeature({ information: null }, 'photos')).toBe(true);
    expect(hasFeature({ information: null }, 'settings')).toBe(false);
  });
});

describe('gimbals', () => {
  const gimbal = (capabilities: number, pitch: [number, number]): Pick<GimbalView, 'information'> => ({
    information: { capabilities, pitch_range: pitch, yaw_range: [-200, 200], vendor: '', model: '' },
  });

  it('turn within the angles that they report', () => {
    const both = GimbalManagerCapFlags.HAS_PITCH_AXIS | GimbalManagerCapFlags.HAS_YAW_AXIS;
    expect(rangesOf(gimbal(both, [-90.000002, 30]))).toEqual({ pitch: [-90, 30], yaw: [-180, 180] });
    expect(rangesOf(gimbal(both, [0, 0])).pitch).toEqual([-90, 90]);
    expect(rangesOf(gimbal(GimbalManagerCapFlags.HAS_PITCH_AXIS, [-90, 30])).yaw).toEqual([0, 0]);
    expect(rangesOf({ information: null })).toEqual({ pitch: [-90, 90], yaw: [-180, 180] });
  });

  it('are moved by the station, whose answer comes once they have accepted', async () => {
    const asked: string[] = [];
    const fetcher = (url: string, init: RequestInit): Promise<Response> => {
      asked.push(`${init.method} ${url} ${String(init.body)}`);
      return Promise.resolve(new Response('{}', { status: 200 }));
    };
    await new Payloads(3, new ApiClient('/api', fetcher as typeof fetch)).moveGimbal('154-1', 'point', { pitch: -30 });
    expect(asked).toEqual(['POST /api/vehicles/3/gimbals/154-1/point?accepted=true {"pitch":-30}']);
  });
});
