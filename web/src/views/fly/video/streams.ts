/** Video sources that vehicles announce (VIDEO_STREAM_INFORMATION), and how a browser can play them. */

export interface VideoStream {
  readonly system: number;
  readonly component: number;
  readonly id: number;
  readonly name: string;
  readonly uri: string;
  /** VIDEO_STREAM_TYPE: 0 RTSP, 1 RTP over UDP, 2 MPEG over TCP, 3 MPEG-TS. */
  readonly type: number;
  readonly width: number;
  readonly height: number;
  readonly frameRate: number;
  readonly isThermal: boolean;
}

const RTP_UDP = 1;
/** VIDEO_STREAM_STATUS_FLAGS. */
const THERMAL = 2;
/** Schemes that a gateway may understand; addresses of others, such as `file:`, are never opened. */
const STREAM_SCHEME = /^(?:rtspu?s?|rtmps?|srt|udp|rtp|tcp|mpegts)(?:\+[a-z]+)?:\/\//i;

/** Return the stream of the fields of VIDEO_STREAM_INFORMATION; null if it has no address. */
export function streamFrom(
  system: number,
  component: number,
  fields: Readonly<Record<string, unknown>>,
): VideoStream | null {
  const uri = String(fields['uri'] ?? '').trim();
  if (uri === '') return null;
  const id = Number(fields['stream_id'] ?? 0);
  return {
    system,
    component,
    id,
    name: String(fields['name'] ?? '').trim() || `Video ${id}`,
    uri,
    type: Number(fields['type'] ?? 0),
    width: Number(fields['resolution_h'] ?? 0),
    height: Number(fields['resolution_v'] ?? 0),
    frameRate: Number(fields['framerate'] ?? 0),
    isThermal: (Number(fields['flags'] ?? 0) & THERMAL) !== 0,
  };
}

/** The URL of the gateway: `{host}` and `{path}` are those of the stream. */
export const DEFAULT_GATEWAY = 'http://{host}:8889/{path}/whep';

export type Player =
  | { readonly kind: 'whep'; readonly url: string }
  | { readonly kind: 'video'; readonly url: string }
  | { readonly kind: 'image'; readonly url: string }
  /** No browser plays it: it needs a gateway. */
  | { readonly kind: 'gateway'; readonly url: string }
  /** Nothing plays it: an unknown scheme, or a password in an address that browsers open without one. */
  | { readonly kind: 'unusable'; readonly url: string; readonly reason: 'scheme' | 'password' };

/** Return how a stream can be played. With a gateway, streams that browsers do not play go by WebRTC (WHEP). */
export function playerFor(uri: string, type = 0, gateway = ''): Player {
  const url = uri.trim();
  if (/^wheps?:/i.test(url)) return httpPlayer(url.replace(/^whep/i, 'http'), 'whep');
  if (/^https?:/i.test(url)) return httpPlayer(url, httpKind(url));
  if (/^[a-z][a-z0-9+.-]*:/i.test(url) && !STREAM_SCHEME.test(url)) return { kind: 'unusable', url, reason: 'scheme' };
  const viaGateway = gatewayUrl(url, type, gateway);
  return viaGateway === null ? { kind: 'gateway', url } : httpPlayer(viaGateway, 'whep');
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

/** Return the URL of a stream at the gateway, or null if there is none or the stream does not tell its host. */
export function gatewayUrl(uri: string, type: number, gateway: string): string | null {
  const template = gateway.trim();
  if (template === '' || type === RTP_UDP) return null;
  const parts = /^[a-z][a-z0-9+.-]*:\/\/(?:[^/@]*@)?(\[[^\]]+\]|[^:/?#]+)(?::\d+)?\/?([^?#]*)/i.exec(uri);
  if (parts === null) return null;
  const path = pathOf(parts[2]!);
  return template.replaceAll('{host}', parts[1]!).replaceAll('{path}', path);
}

/** Return the path of a stream at the gateway; a camera cannot leave it by `..`. */
function pathOf(path: string): string {
  const parts = path.split('/').filter((part) => part !== '' && !/^(?:\.|%2e){1,2}$/i.test(part));
  return parts.map((part) => part.replace(/[^\w.~%-]/g, encodeURIComponent)).join('/') || 'video';
}

/** Return the configuration of the gateway MediaMTX for a stream. */
export function gatewayConfiguration(stream: VideoStream): string {
  const name = stream.uri.replace(/^[a-z]+:\/\/[^/]*\/?/i, '').replace(/[^\w/-]/g, '') || 'video';
  // A camera chooses its address: quoted, it cannot add options of the gateway, some of which run programs.
  return `paths:\n  ${name}:\n    source: ${JSON.stringify(stream.uri)}\n    sourceOnDemand: yes\n`;
}
