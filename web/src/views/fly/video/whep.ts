/** Receives a stream by WebRTC: offer and answer go by one HTTP request (WHEP), the rest is the browser's. */

export interface WhepSession {
  close(): void;
}

/** Local candidates are sent with the offer; a gateway in the local network needs no more. */
const CANDIDATES_TIMEOUT = 1500;

/** Connect and show the stream in `video`; rejects with the reason, reports a later loss to `onlost`. */
export async function playWhep(url: string, video: HTMLVideoElement, onlost: () => void): Promise<WhepSession> {
  const peer = new RTCPeerConnection();
  let resource: string | null = null;
  const close = (): void => {
    peer.close();
    video.srcObject = null;
    if (resource !== null) fetch(resource, { method: 'DELETE' }).catch(() => undefined);
  };
  try {
    peer.addTransceiver('video', { direction: 'recvonly' });
    peer.addTransceiver('audio', { direction: 'recvonly' });
    peer.ontrack = ({ streams }) => {
      video.srcObject = streams[0] ?? null;
    };
    peer.onconnectionstatechange = () => {
      if (peer.connectionState === 'failed' || peer.connectionState === 'disconnected') onlost();
    };
    await peer.setLocalDescription(await peer.createOffer());
    await gathered(peer);
    const answer = await fetch(url, {
      method: 'POST',
      headers: { 'Content-Type': 'application/sdp' },
      body: peer.localDescription!.sdp,
    });
    if (!answer.ok) throw new Error(`the gateway answered ${answer.status} ${answer.statusText}`);
    const location = answer.headers.get('Location');
    resource = location === null ? null : new URL(location, url).href;
    await peer.setRemoteDescription({ type: 'answer', sdp: await answer.text() });
    return { close };
  } catch (error) {
    close();
    throw error;
  }
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
