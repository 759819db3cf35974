import { expect, it } from 'vitest';

import { DEFAULT_GATEWAY } from './gateway';
import { withoutPassword } from './recordings.svelte';
import { isTakenByStation, playerFor, streamFrom } from './streams';
import { requestOf, resourceOf } from './whep';

const FIELDS = {
  stream_id: 1,
  name: 'Front',
  uri: 'rtsp://10.0.0.5:8554/front',
  type: 0,
  resolution_h: 1280,
  resolution_v: 720,
  framerate: 30,
};

it('reads VIDEO_STREAM_INFORMATION, and nothing without an address', () => {
  expect(streamFrom(1, 100, FIELDS)).toMatchObject({ id: 1, name: 'Front', width: 1280, uri: FIELDS.uri });
  expect(streamFrom(1, 100, { ...FIELDS, name: '' })?.name).toBe('Video 1');
  expect(streamFrom(1, 100, { ...FIELDS, uri: ' ' })).toBeNull();
});

it('plays RTSP and RTP through the station, and a gateway comes first', () => {
  const station = 'http://127.0.0.1:8080/api/video/whep';
  expect(playerFor('rtsp://cam:8554/front', 0, '', station)).toEqual({
    kind: 'whep',
    url: `${station}?uri=rtsp%3A%2F%2Fcam%3A8554%2Ffront`,
  });
  expect(playerFor('5600', 1, '', station).url).toBe(`${station}?uri=5600`);
  expect(playerFor('5600', 1, '', station, true).url).toBe(`${station}?uri=5600&h265=true`);
  expect([isTakenByStation('rtsp://cam/a'), isTakenByStation('5600', 3), isTakenByStation('http://cam')]).toEqual([
    true,
    false,
    false,
  ]);
  expect(withoutPassword(' rtsp://user:word@cam/a ')).toBe('rtsp://***@cam/a');
  expect(withoutPassword('rtsp://user:w@rd@cam/a')).toBe('rtsp://***@cam/a');
  expect(withoutPassword('rtsp://cam/a?user=u&password=w')).toBe('rtsp://cam/a?user=u&password=***');
  expect(playerFor('rtsp://cam:8554/front', 0, DEFAULT_GATEWAY, station).url).toBe('http://cam:8889/front/whep');
  expect(playerFor('5600', 3, '', station).kind).toBe('gateway');
  expect(playerFor('srt://cam:9000', 0, '', station).kind).toBe('gateway');
  expect(playerFor('javascript:alert(1)', 0, '', station).kind).toBe('unusable');
});

it('plays what browsers play', () => {
  expect(playerFor('http://cam:8889/front/whep').kind).toBe('whep');
  expect(playerFor('wheps://cam/front').url).toBe('https://cam/front');
  expect(playerFor('http://cam:8080/?action=stream').kind).toBe('image');
  expect(playerFor('http://cam/live.mp4').kind).toBe('video');
  expect(playerFor('http://cam:8889/front', 4)).toEqual({ kind: 'whep', url: 'http://cam:8889/front' });
});

it('needs a gateway for RTSP and RTP, and uses it', () => {
  expect(playerFor(FIELDS.uri)).toEqual({ kind: 'gateway', url: FIELDS.uri });
  expect(playerFor(FIELDS.uri, 0, DEFAULT_GATEWAY)).toEqual({ kind: 'whep', url: 'http://10.0.0.5:8889/front/whep' });
  expect(playerFor('rtsp://user:word@cam/', 0, 'http://localhost:8889/{path}/whep').url).toBe(
    'http://localhost:8889/video/whep',
  );
  expect(playerFor('5600', 1, DEFAULT_GATEWAY)).toEqual({ kind: 'gateway', url: '5600' });
  expect(playerFor('not a url', 0, DEFAULT_GATEWAY).kind).toBe('gateway');
});

it('opens nothing but video: no scripts, no files, no pictures with a password', () => {
  for (const uri of [
    'javascript:alert(1)',
    'javascript://cam/%0aalert(1)',
    'file:///etc/passwd',
    'data:text/html,x',
    'blob:x',
    'http://',
  ]) {
    expect(playerFor(uri, 0, DEFAULT_GATEWAY)).toMatchObject({ kind: 'unusable', reason: 'scheme' });
  }
  expect(playerFor('http://user:word@cam/live.mp4')).toMatchObject({ kind: 'unusable', reason: 'password' });
  expect(playerFor('http://user:word@cam/front/whep').kind).toBe('whep');
  expect(playerFor('rtsp://cam/front', 0, 'javascript:alert("{path}")')).toMatchObject({ kind: 'unusable' });
});

it('sends a password of a gateway as a header, and ends its sessions at the gateway only', () => {
  expect(requestOf('http://gateway/front/whep')).toEqual({ url: 'http://gateway/front/whep', headers: {} });
  expect(requestOf('http://me:p%40ss@gateway/front/whep')).toEqual({
    url: 'http://gateway/front/whep',
    headers: { Authorization: `Basic ${btoa('me:p@ss')}` },
  });
  expect(resourceOf('/front/whep/1', 'http://gateway/front/whep')).toBe('http://gateway/front/whep/1');
  expect(resourceOf('http://other/1', 'http://gateway/front/whep')).toBeNull();
  expect(resourceOf(null, 'http://gateway/front/whep')).toBeNull();
});

it('tells a thermal picture and the encoding', () => {
  expect(streamFrom(1, 100, { ...FIELDS, encoding: 2 })?.isH265).toBe(true);
  expect(streamFrom(1, 100, { ...FIELDS, encoding: 1 })?.isH265).toBe(false);
  expect(streamFrom(1, 100, { ...FIELDS, flags: 3 })?.isThermal).toBe(true);
  expect(streamFrom(1, 100, { ...FIELDS, flags: 1 })?.isThermal).toBe(false);
});
