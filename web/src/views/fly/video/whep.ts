/** Receives a stream by WebRTC: offer and answer go by one HTTP request (WHEP), the rest is the browser's. */

export interface WhepSession {
  close(): void;
}

/** Local candidates are sent with the offer; a gateway in the local network needs no more. */
const CANDIDATES_TIMEOUT = 1500;
/** A gateway that does not answer. */
const ANSWER_TIMEOUT = 10_000;

/** Connect and show the stream in `video`; rejects with the reason, reports a later loss to `onlost`. */
export async function playWhep(address: string, video: HTMLVideoElement, onlost: () => void): Promise<WhepSession> {
  const { url, headers } = requestOf(address);
  const peer = new RTCPeerConnection();
  let resource: string | null = null;
  const close = (): void => {
    peer.onconnectionstatechange = null;
    peer.close();
    video.srcObject = null;
    if (resource !== null) fetch(resource, { method: 'DELETE', headers, keepalive: true }).catch(() => undefined);
  };
  try {
    peer.addTransceiver('video', { direction: 'recvonly' });
    peer.addTransceiver('audio', { direction: 'recvonly' });
    const shown = new MediaStream();
    peer.ontrack = ({ track }) => {
      // A gateway need not name the stream of its tracks.
      shown.addTrack(track);
      video.srcObject = shown;
    };
    peer.onconnectionstatechange = () => {
      if (peer.connectionState === 'failed' || peer.connectionState === 'disconnected') onlost();
    };
    await peer.setLocalDescription(await peer.createOffer());
    await gathered(peer);
    const answer = await fetch(url, {
      method: 'POST',
      headers: { ...headers, 'Content-Type': 'application/sdp' },
      body: peer.localDescription!.sdp,
      signal: AbortSignal.timeout(ANSWER_TIMEOUT),
    });
    if (!answer.ok) throw new Error(`the gateway answered ${answer.status} ${answer.statusText}`);
    resource = resourceOf(answer.headers.get('Location'), url);
    await peer.setRemoteDescription({ type: 'answer', sdp: await answer.text() });
    return { close };
  } catch (error) {
    close();
    throw error;
  }
}

/** Returns the address of the session, if it is one of the gateway: another host gets no request. */
export function resourceOf(location: string | null, url: string): string | null {
  if (location === null) return null;
  const resource = new URL(location, url);
  return resource.origin === new URL(url).origin ? resource.href : null;
}

/** Returns an address without its password, which goes into a header: browsers fetch no address with one. */
export function requestOf(address: string): { url: string; headers: Readonly<Record<string, string>> } {
  const url = new URL(address);
  const { username, password } = url;
  if (username === '' && password === '') return { url: url.href, headers: {} };
  url.username = url.password = '';
  const text = `${decodeURIComponent(username)}:${decodeURIComponent(password)}`;
  const bytes = Array.from(new TextEncoder().encode(text), (byte) => String.fromCharCode(byte));
  return { url: url.href, headers: { Authorization: `Basic ${btoa(bytes.join(''))}` } };
}

function gathered(peer: RTCPeerConnection): Promise<void> {
  if (peer.iceGatheringState === 'complete') return Promise.resolve();
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, CANDIDATES_TIMEOUT);
    peer.onicegatheringstatechange = () => {
      if (peer.iceGatheringState !== 'complete') return;
      clearTimeout(timer);
      resolve();
    };
  });
}
