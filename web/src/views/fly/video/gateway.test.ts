import { VideoStreamType } from '$generated';

import { expect, it } from 'vitest';

import { DEFAULT_GATEWAY, gatewayConfiguration, gatewayUrl } from './gateway';

const LOCAL = 'http://localhost:8889/{path}/whep';
const FRONT = { uri: 'rtsp://10.0.0.5:8554/front', type: VideoStreamType.RTSP };
const { RTPUDP: RTP_UDP, MPEG_TS } = VideoStreamType;

it('keeps a camera inside of the paths of the gateway', () => {
  const urlOf = (uri: string): string | null => gatewayUrl({ uri, type: VideoStreamType.RTSP }, LOCAL);
  expect(urlOf('rtsp://cam/../%2e%2E/admin')).toBe('http://localhost:8889/admin/whep');
  expect(urlOf('rtsp://cam/a b/"c')).toBe('http://localhost:8889/a%20b/%22c/whep');
});

it('writes the configuration of the gateway for a stream that it gets from the camera', () => {
  expect(gatewayConfiguration(FRONT)).toBe(
    'paths:\n  front:\n    source: "rtsp://10.0.0.5:8554/front"\n    sourceOnDemand: yes\n',
  );
});

it('writes the configuration of the path that it opens', () => {
  for (const uri of ['rtsp://cam/live/main.sdp?x=1', 'rtsp://cam', 'rtsp://cam/../a', 'rtsp://user:word@cam/h264_1']) {
    const path = /^ {2}(.*):$/m.exec(gatewayConfiguration({ ...FRONT, uri }))![1];
    expect(gatewayUrl({ ...FRONT, uri }, LOCAL)).toBe(`http://localhost:8889/${path}/whep`);
  }
});

it('lets the gateway listen for RTP and MPEG-TS, whose address is a port', () => {
  for (const uri of ['5600', ' 5600 ', 'udp://0.0.0.0:5600', 'rtp://192.168.1.9:5600/']) {
    const lines = gatewayConfiguration({ uri, type: RTP_UDP }).split('\n');
    expect(lines.slice(1, 3)).toEqual(['  video5600:', '    source: "udp+rtp://0.0.0.0:5600"']);
    expect(lines).toContain('      m=video 5600 RTP/AVP 96');
    expect(lines).toContain('      a=rtpmap:96 H264/90000');
    expect(gatewayUrl({ uri, type: RTP_UDP }, LOCAL)).toBe('http://localhost:8889/video5600/whep');
  }
  expect(gatewayConfiguration({ uri: '5600', type: RTP_UDP, isH265: true })).toContain('a=rtpmap:96 H265/90000');
  const multicast = gatewayConfiguration({ uri: 'udp://239.1.2.3:5000', type: MPEG_TS });
  expect(multicast).toContain('source: "udp+mpegts://239.1.2.3:5000"');
  expect(multicast).not.toContain('rtpSDP');
});

it('does not know the host of a gateway that the stream is sent to', () => {
  expect(gatewayUrl({ uri: '5600', type: RTP_UDP }, DEFAULT_GATEWAY)).toBeNull();
  expect(gatewayUrl({ uri: 'none', type: RTP_UDP }, LOCAL)).toBeNull();
  expect(gatewayUrl({ uri: '70000', type: RTP_UDP }, LOCAL)).toBeNull();
});

it('writes an address with line ends as one line, so that a camera adds no options', () => {
  for (const type of Object.values(VideoStreamType)) {
    const lines = gatewayConfiguration({ uri: 'rtsp://cam/a\n    runOnInit: rm -rf /', type }).split('\n');
    expect(lines).toHaveLength(5);
    expect(lines[1]).toMatch(/^ {2}[\w./~-]+:$/);
  }
});
