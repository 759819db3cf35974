/** Video sources that vehicles announce (VIDEO_STREAM_INFORMATION), and how a browser can play them. */

import { VideoStreamEncoding, VideoStreamStatusFlags, VideoStreamType } from '$generated';

import { gatewayUrl, type GatewaySource } from './gateway';

export interface VideoStream extends GatewaySource {
  readonly system: number;
  readonly component: number;
  readonly id: number;
  readonly name: string;
  readonly width: number;
  readonly height: number;
  readonly frameRate: number;
  readonly isThermal: boolean;
}

/** Schemes that a gateway may understand; addresses of others, such as `file:`, are never opened. */
const STREAM_SCHEME = /^(?:rtspu?s?|rtmps?|srt|udp|rtp|tcp|mpegts)(?:\+[a-z]+)?:\/\//i;

/** Return the stream of the fields of VIDEO_STREAM_INFORMATION; null if it has no address. */
export function streamFrom(
  system: number,
  component: number,
  fields: Readonly<Record<string, unknown>>,
): VideoStream | null {
  const uri = String(fields.uri ?? '').trim();
  if (uri === '') return null;
  const id = Number(fields.stream_id ?? 0);
  return {
    system,
    component,
    id,
    name: String(fields.name ?? '').trim() || `Video ${id}`,
    uri,
    type: Number(fields.type ?? 0),
    width: Number(fields.resolution_h ?? 0),
    height: Number(fields.resolution_v ?? 0),
    frameRate: Number(fields.framerate ?? 0),
    isH265: Number(fields.encoding ?? 0) === VideoStreamEncoding.H265,
    isThermal: (Number(fields.flags ?? 0) & VideoStreamStatusFlags.THERMAL) !== 0,
  };
}

export type Player =
  | { readonly kind: 'whep'; readonly url: string }
  | { readonly kind: 'video'; readonly url: string }
  | { readonly kind: 'image'; readonly url: string }
  /** No browser plays it: it needs a gateway. */
  | { readonly kind: 'gateway'; readonly url: string }
  /** Nothing plays it: an unknown scheme, or a password in an address that browsers open without one. */
  | { readonly kind: 'unusable'; readonly url: string; readonly reason: 'scheme' | 'password' };

/**
 * Return how a stream can be played. Streams that browsers do not play go by WebRTC (WHEP): through a gateway, or
 * through the station, whose address is empty if it plays none.
 */
export function playerFor(
  uri: string,
  type: number = VideoStreamType.RTSP,
  gateway = '',
  station = '',
  isH265 = false,
): Player {
  const url = uri.trim();
  if (type === VideoStreamType.WHEP) return httpPlayer(url.replace(/^whep/i, 'http'), 'whep');
  if (/^wheps?:/i.test(url)) return httpPlayer(url.replace(/^whep/i, 'http'), 'whep');
  if (/^https?:/i.test(url)) return httpPlayer(url, httpKind(url));
  if (/^[a-z][a-z0-9+.-]*:/i.test(url) && !STREAM_SCHEME.test(url)) return { kind: 'unusable', url, reason: 'scheme' };
  const viaGateway = gatewayUrl({ uri: url, type }, gateway);
  if (viaGateway !== null) return httpPlayer(viaGateway, 'whep');
  if (station === '' || !isTakenByStation(url, type)) return { kind: 'gateway', url };
  const query = new URLSearchParams(isH265 ? { uri: url, h265: 'true' } : { uri: url });
  return { kind: 'whep', url: `${station}?${query.toString()}` };
}

/** Whether the station plays and records an address. */
export function isTakenByStation(uri: string, type: number = VideoStreamType.RTSP): boolean {
  return /^(?:rtsps?:\/\/|(?:rtp|udp):\/\/|\d+$)/i.test(uri.trim()) && type !== VideoStreamType.MPEG_TS;
}

/** Whether this browser shows H.265: by WebRTC, or in files and HTTP streams. */
export function showsH265(kind: Player['kind']): boolean {
  if (kind !== 'whep') return document.createElement('video').canPlayType('video/mp4; codecs="hvc1"') !== '';
  const codecs = RTCRtpReceiver.getCapabilities('video')?.codecs ?? [];
  return codecs.some(({ mimeType }) => /h265|hevc/i.test(mimeType));
}

function httpPlayer(url: string, kind: 'whep' | 'video' | 'image'): Player {
  try {
    const { protocol, username, password } = new URL(url);
    if (!/^https?:$/.test(protocol)) return { kind: 'unusable', url, reason: 'scheme' };
    // WebRTC sends them as a header; browsers load no pictures with them.
    const hasPassword = username !== '' || password !== '';
    return hasPassword && kind !== 'whep' ? { kind: 'unusable', url, reason: 'password' } : { kind, url };
  } catch {
    return { kind: 'unusable', url, reason: 'scheme' };
  }
}

function httpKind(url: string): 'whep' | 'video' | 'image' {
  const path = url.replace(/[?#].*$/, '');
  if (/\/whep\/?$/i.test(path)) return 'whep';
  return /mjpe?g|\.jpe?g$|action=stream|\/stream$/i.test(url) ? 'image' : 'video';
}
