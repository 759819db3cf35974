import { expect, it } from 'vitest';

import { DEFAULT_GATEWAY, gatewayConfiguration, playerFor, streamFrom } from './streams';

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

it('plays what browsers play', () => {
  expect(playerFor('http://cam:8889/front/whep').kind).toBe('whep');
  expect(playerFor('wheps://cam/front').url).toBe('https://cam/front');
  expect(playerFor('http://cam:8080/?action=stream').kind).toBe('image');
  expect(playerFor('http://cam/live.mp4').kind).toBe('video');
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

it('writes the configuration of the gateway', () => {
  expect(gatewayConfiguration(streamFrom(1, 100, FIELDS)!)).toBe(
    'paths:\n  front:\n    source: "rtsp://10.0.0.5:8554/front"\n    sourceOnDemand: yes\n',
  );
});

it('writes an address with line ends as one line, so that a camera adds no options', () => {
  const uri = 'rtsp://cam/a\n    runOnInit: rm -rf /';
  const lines = gatewayConfiguration(streamFrom(1, 100, { ...FIELDS, uri })!).split('\n');
  expect(lines).toHaveLength(5);
  expect(lines[1]).toBe('  arunOnInitrm-rf/:');
});
