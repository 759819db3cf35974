/**
 * The gateway that turns streams which no browser plays into WebRTC: its WHEP addresses, and its configuration.
 *
 * A camera chooses the addresses of its streams. What it writes there must neither leave the paths of the gateway nor
 * add options to its configuration, some of which run programs.
 */

import { VideoStreamType } from '$generated';

/** A stream that a gateway takes. */
export interface GatewaySource {
  readonly uri: string;
  /** VIDEO_VideoStreamType. */
  readonly type: number;
  readonly isH265?: boolean;
}

/** The default URL of the gateway: `{host}` and `{path}` are those of the stream. */
export const DEFAULT_GATEWAY = 'http://{host}:8889/{path}/whep';

/** The MediaMTX source of streams that are sent to one of its ports. */
const RECEIVED: ReadonlyMap<number, string> = new Map([
  [VideoStreamType.RTPUDP, 'udp+rtp'],
  [VideoStreamType.MPEG_TS, 'udp+mpegts'],
]);
const MULTICAST = /\b2(?:2[4-9]|3\d)(?:\.\d{1,3}){3}\b/;
/** Of RTP, by the usual dynamic payload type of H.264 and H.265. */
const PAYLOAD_TYPE = 96;

/** Returns the URL of a stream at the gateway, or null if there is none or the stream does not tell its host. */
export function gatewayUrl({ uri, type }: GatewaySource, gateway: string): string | null {
  const template = gateway.trim();
  if (template === '') return null;
  if (RECEIVED.has(type)) {
    // Where it is sent to is the gateway, of which the address tells nothing but the port.
    const port = portOf(uri);
    return port === null || template.includes('{host}') ? null : template.replaceAll('{path}', receivedPath(port));
  }
  const parts = /^[a-z][a-z0-9+.-]*:\/\/(?:[^/@]*@)?(\[[^\]]+\]|[^:/?#]+)(?::\d+)?\/?([^?#]*)/i.exec(uri);
  if (parts === null) return null;
  return template.replaceAll('{host}', parts[1]!).replaceAll('{path}', pathOf(parts[2]!));
}

/** Returns the configuration of the gateway MediaMTX for a stream. */
export function gatewayConfiguration(source: GatewaySource): string {
  const { uri, type, isH265 } = source;
  const port = portOf(uri);
  const scheme = RECEIVED.get(type);
  if (scheme === undefined || port === null) return pathConfiguration(pulledPath(uri), uri);
  const host = MULTICAST.exec(uri)?.[0] ?? '0.0.0.0';
  const configuration = pathConfiguration(receivedPath(port), `${scheme}://${host}:${port}`);
  return type === VideoStreamType.RTPUDP ? configuration + sessionDescription(port, isH265 ?? false) : configuration;
}

function pathConfiguration(path: string, source: string): string {
  return `paths:\n  ${path}:\n    source: ${JSON.stringify(source)}\n    sourceOnDemand: yes\n`;
}

/** RTP does not tell its format: the session description does. */
function sessionDescription(port: number, isH265: boolean): string {
  const lines = [
    'v=0',
    'o=- 0 0 IN IP4 127.0.0.1',
    's=video',
    'c=IN IP4 0.0.0.0',
    't=0 0',
    `m=video ${port} RTP/AVP ${PAYLOAD_TYPE}`,
    `a=rtpmap:${PAYLOAD_TYPE} ${isH265 ? 'H265' : 'H264'}/90000`,
  ];
  return `    rtpSDP: |\n${lines.map((line) => `      ${line}\n`).join('')}`;
}

/** Returns the port of an address such as `5600` or `udp://0.0.0.0:5600`. */
function portOf(uri: string): number | null {
  const port = Number(/^\s*(?:.*:)?(\d{1,5})\/?\s*$/.exec(uri)?.[1] ?? 0);
  return port > 0 && port < 65_536 ? port : null;
}

function receivedPath(port: number): string {
  return `video${port}`;
}

/** Returns the name of a path in the configuration, of characters that are no syntax there. */
function pulledPath(uri: string): string {
  const path = uri.replace(/^[a-z][a-z0-9+.-]*:\/\/[^/]*\/?/i, '').replace(/[?#].*$/s, '');
  return pathOf(path.replace(/[^\w./~-]/g, ''));
}

/** Returns the path of a stream at the gateway; a camera cannot leave it by `..`. */
function pathOf(path: string): string {
  const parts = path.split('/').filter((part) => part !== '' && !/^(?:\.|%2e){1,2}$/i.test(part));
  return parts.map((part) => part.replace(/[^\w.~%-]/g, encodeURIComponent)).join('/') || 'video';
}
