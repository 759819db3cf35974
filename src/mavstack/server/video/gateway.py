"""The viewers of the station's video: each has a WebRTC connection, made by one HTTP request (WHEP).

Viewers and cameras are bounded. A connection that fails, is not made in time, or is closed by its browser
frees its place, and the last viewer of a camera closes it.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from secrets import token_urlsafe
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.http.bodies import RefusedError
from mavstack.server.video.sources import CameraSource, open_source

try:
    from aiortc import RTCConfiguration, RTCPeerConnection, RTCRtpSender, RTCSessionDescription
except ImportError as missing:
    raise MissingExtraError("video in the station", "video") from missing

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Coroutine

    from aiortc import RTCRtpCodecCapability

    from mavstack.server.video.addresses import CameraAddress

#: Maximum number of simultaneous viewers, and of cameras.
MAX_VIEWERS: Final = 16
MAX_CAMERAS: Final = 8
#: Seconds in which a browser must establish its connection after the request.
CONNECT_TIMEOUT: Final = 20.0
_ENDED: Final = frozenset({"failed", "closed"})


@dataclass(slots=True)
class _Viewer:
    peer: RTCPeerConnection
    key: tuple[CameraAddress, bool]


@dataclass(slots=True)
class Answer:
    """The answer to an offer: the name of the viewer, and its session description."""

    name: str
    sdp: str = field(repr=False)


class VideoGateway:
    """All viewers of a station."""

    def __init__(self) -> None:
        self._viewers: dict[str, _Viewer] = {}
        #: The cameras that others than viewers keep open, by a name for each of them.
        self._kept: dict[str, tuple[CameraAddress, bool]] = {}
        self._sources: dict[tuple[CameraAddress, bool], CameraSource] = {}
        self._opening = asyncio.Lock()
        self._closing: set[asyncio.Future[object]] = set()

    @property
    def viewers(self) -> int:
        """Number of viewers."""
        return len(self._viewers)

    @property
    def cameras(self) -> int:
        """Number of open cameras."""
        return len(self._sources)

    def plays(self, address: CameraAddress) -> bool:
        """Return whether a camera is open."""
        return any(key[0] == address for key in self._sources)

    async def watch(self, address: CameraAddress, offer: str) -> Answer:
        """Answer the offer of a browser.

        Args:
            address: The camera.
            offer: The session description of the browser.

        Returns:
            The answer.

        Raises:
            RefusedError: There are too many viewers or cameras, or the offer is malformed.
            LinkError: The camera does not answer.
        """
        if len(self._viewers) >= MAX_VIEWERS:
            raise RefusedError(503, f"{MAX_VIEWERS} viewers watch already")
        if "m=video " not in offer:
            raise RefusedError(400, "the offer asks for no video")
        key = (address, "H264/90000" in offer)
        peer, name = RTCPeerConnection(RTCConfiguration(iceServers=[])), token_urlsafe(12)
        self._viewers[name] = _Viewer(peer, key)
        try:
            source = await self._source(key)
            sdp = await self._connect(name, source, offer)
        except BaseException:
            await self.leave(name)
            raise
        asyncio.get_running_loop().call_later(CONNECT_TIMEOUT, self._check_connected, name)
        return Answer(name, sdp)

    @asynccontextmanager
    async def camera(self, address: CameraAddress) -> AsyncIterator[CameraSource]:
        """Keep a camera open, shared with its viewers, until the block ends.

        Args:
            address: The camera.

        Yields:
            The open camera.

        Raises:
            RefusedError: Too many cameras are open.
            LinkError: The camera does not answer.
        """
        name, key = token_urlsafe(12), (address, True)
        self._kept[name] = key
        try:
            yield await self._source(key)
        finally:
            del self._kept[name]
            await self._end_unused(key)

    async def leave(self, name: str) -> bool:
        """End a viewer; return False if there is none of this name."""
        viewer = self._viewers.pop(name, None)
        if viewer is None:
            return False
        await self._end_unused(viewer.key)
        await viewer.peer.close()
        return True

    async def close(self) -> None:
        """End all viewers, and wait until all cameras are closed."""
        await asyncio.gather(*map(self.leave, tuple(self._viewers)))
        await asyncio.gather(*self._closing)

    async def _end_unused(self, key: tuple[CameraAddress, bool]) -> None:
        if key not in self._kept.values() and all(each.key != key for each in self._viewers.values()):
            await self._end_source(key)

    async def _end_source(self, key: tuple[CameraAddress, bool]) -> None:
        source = self._sources.pop(key, None)
        if source is not None:
            await asyncio.shield(self._in_background(source.close()))

    def _in_background(self, work: Coroutine[Any, Any, object]) -> asyncio.Future[object]:
        """Run what `close` waits for."""
        self._closing.add(closing := asyncio.ensure_future(work))
        closing.add_done_callback(self._closing.discard)
        return closing

    def _check_connected(self, name: str) -> None:
        viewer = self._viewers.get(name)
        if viewer is not None and viewer.peer.connectionState != "connected":
            self._in_background(self.leave(name))

    async def _source(self, key: tuple[CameraAddress, bool]) -> CameraSource:
        async with self._opening:
            if key in self._sources and not self._sources[key].is_live:
                await self._end_source(key)
            if key not in self._sources:
                if len(self._sources) >= MAX_CAMERAS:
                    raise RefusedError(503, f"{MAX_CAMERAS} cameras are open already")
                self._sources[key] = await open_source(key[0], passes_h264=key[1])
            return self._sources[key]

    async def _connect(self, name: str, source: CameraSource, offer: str) -> str:
        peer = self._viewers[name].peer

        @peer.on("connectionstatechange")
        async def follow() -> None:
            if peer.connectionState in _ENDED:
                await self.leave(name)

        peer.addTrack(source.subscribe())
        if source.codec:  # set before `setRemoteDescription`, which chooses the codec from the offer
            peer.getTransceivers()[0].setCodecPreferences(_codecs(source.codec))
        try:
            await peer.setRemoteDescription(RTCSessionDescription(offer, "offer"))
        except (ValueError, LookupError, AttributeError, AssertionError) as error:
            raise RefusedError(400, f"the offer is malformed: {error}") from None
        await peer.setLocalDescription(await peer.createAnswer())
        return peer.localDescription.sdp


def _codecs(name: str) -> list[RTCRtpCodecCapability]:
    """Return the codecs to offer for a stream that is passed on: its own alone."""
    codecs = RTCRtpSender.getCapabilities("video").codecs
    return [each for each in codecs if each.mimeType.lower() == f"video/{name}"]
