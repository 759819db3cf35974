"""A WebRTC gateway for tests: aiortc answers WHEP requests with a picture that moves.

Its answers have the form of MediaMTX's: 201 with `Location`, headers for pages of other origins, 404 for a
path without a stream.
"""

from __future__ import annotations

import asyncio
import threading
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Colours of the pictures by path: the bar that moves over black.
COLOURS: Final = {"front": (230, 30, 30), "thermal": (30, 200, 30)}
_HEIGHT, _WIDTH, _RATE, _CLOCK = 180, 320, 20, 90_000
_CORS: Final = {
    "Access-Control-Allow-Origin": "*",
    "Access-Control-Allow-Methods": "OPTIONS, POST, DELETE",
    "Access-Control-Allow-Headers": "Authorization, Content-Type",
    "Access-Control-Expose-Headers": "Location",
}


@dataclass
class WhepGateway:
    """A running gateway; `requests` are method and path of each request."""

    url: str = ""
    requests: list[tuple[str, str]] = field(default_factory=list)
    peers: dict[str, Any] = field(default_factory=dict)
    loop: asyncio.AbstractEventLoop | None = None

    def drop_all(self) -> None:
        """End all connections, as a gateway that restarts."""
        assert self.loop is not None
        asyncio.run_coroutine_threadsafe(self.close(), self.loop).result(30)

    async def close(self) -> None:
        peers, self.peers = list(self.peers.values()), {}
        for peer in peers:
            await peer.close()


def picture(colour: tuple[int, int, int], index: int) -> np.ndarray:
    """Return a picture with a bar whose place tells its number."""
    pixels = np.zeros((_HEIGHT, _WIDTH, 3), np.uint8)
    left = index * 8 % (_WIDTH - 80)
    pixels[:, left : left + 80] = colour
    return pixels


def _track(colour: tuple[int, int, int]) -> Any:
    aiortc, av = pytest.importorskip("aiortc"), pytest.importorskip("av")

    class MovingBar(aiortc.MediaStreamTrack):  # type: ignore[name-defined]
        kind = "video"
        index = 0

        async def recv(self) -> Any:
            await asyncio.sleep(1 / _RATE)
            self.index += 1
            frame = av.VideoFrame.from_ndarray(picture(colour, self.index), format="rgb24")
            frame.pts, frame.time_base = self.index * _CLOCK // _RATE, Fraction(1, _CLOCK)
            return frame

    return MovingBar()


def _application(gateway: WhepGateway) -> Any:
    aiortc = pytest.importorskip("aiortc")
    applications = pytest.importorskip("starlette.applications")
    responses, routing = (pytest.importorskip(f"starlette.{name}") for name in ("responses", "routing"))

    async def offer(request: Any) -> Any:
        path = request.path_params["path"]
        gateway.requests.append((request.method, path))
        if request.method == "OPTIONS":
            return responses.Response(status_code=204, headers=_CORS)
        if request.method == "DELETE":
            peer = gateway.peers.pop(path, None)
            if peer is not None:
                await peer.close()
            return responses.Response(status_code=200, headers=_CORS)
        colour = COLOURS.get(path)
        if colour is None:
            return responses.Response("no stream is available", status_code=404, headers=_CORS)
        peer = aiortc.RTCPeerConnection()
        sdp = (await request.body()).decode()
        peer.addTrack(_track(colour))
        await peer.setRemoteDescription(aiortc.RTCSessionDescription(sdp, "offer"))
        await peer.setLocalDescription(await peer.createAnswer())
        name = f"{path}-{len(gateway.requests)}"
        gateway.peers[name] = peer
        headers = {**_CORS, "Location": f"/{name}/whep", "Content-Type": "application/sdp"}
        return responses.Response(peer.localDescription.sdp, status_code=201, headers=headers)

    route = routing.Route("/{path:path}/whep", offer, methods=["POST", "DELETE", "OPTIONS"])
    return applications.Starlette(routes=[route])


@contextmanager
def whep_gateway() -> Iterator[WhepGateway]:
    """Run the gateway in a thread, on a free port."""
    uvicorn = pytest.importorskip("uvicorn")
    gateway, ready = WhepGateway(), threading.Event()
    config = uvicorn.Config(_application(gateway), host="127.0.0.1", port=0, log_level="warning")
    server = uvicorn.Server(config)

    async def run() -> None:
        gateway.loop = asyncio.get_running_loop()
        serving = asyncio.create_task(server.serve())
        while not server.started:  # noqa: ASYNC110 (uvicorn has no event for it)
            await asyncio.sleep(0.01)
        port = server.servers[0].sockets[0].getsockname()[1]
        gateway.url = f"http://127.0.0.1:{port}"
        ready.set()
        await serving
        await gateway.close()

    thread = threading.Thread(target=asyncio.run, args=(run(),))
    thread.start()
    assert ready.wait(30)
    yield gateway
    server.should_exit = True
    thread.join()
