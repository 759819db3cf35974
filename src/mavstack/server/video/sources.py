"""Open cameras. A camera is opened once for all its viewers, and closed after the last one.

H.264 is passed on as the camera made it, which costs neither a decoder nor an encoder; another codec, or a
browser without H.264, costs both.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LinkError, MissingExtraError

try:
    import av
    from aiortc.contrib.media import MediaPlayer, MediaRelay
except ImportError as missing:
    raise MissingExtraError("video in the station", "video") from missing

if TYPE_CHECKING:
    from aiortc import MediaStreamTrack

    from mavstack.server.video.addresses import CameraAddress

#: Timeout of the connection to a camera in seconds.
OPEN_TIMEOUT: Final = 10
#: Options of FFmpeg for streams with a low delay.
_OPTIONS: Final = {
    "flags": "low_delay",
    "analyzeduration": "1000000",
    "probesize": "500000",
}
#: Drops the packets that were read to recognise the stream. A decoder needs them: the first picture may be
#: the only one for seconds that needs no other, and the player ends a stream whose decoder fails.
_NO_BUFFER: Final = {"fflags": "nobuffer"}
_RTSP: Final = {"rtsp_transport": "tcp", "timeout": str(OPEN_TIMEOUT * 1_000_000)}
_RTP: Final = {"protocol_whitelist": "file,udp,rtp", "reorder_queue_size": "64"}
_H264: Final = "h264"

logger = logging.getLogger("mavstack.server")


class CameraSource:
    """One open camera.

    Args:
        player: The open stream.
        track: Its video.
        codec: The name of its codec as it is passed on; empty: it is decoded.
    """

    def __init__(self, player: MediaPlayer, track: Any, codec: str) -> None:  # noqa: ANN401 (its player is not in its type)
        self.codec = codec
        self._player, self._track = player, track
        self._relay = MediaRelay()

    @property
    def is_live(self) -> bool:
        """True until the camera has ended its stream."""
        return bool(self._track.readyState == "live")

    def subscribe(self) -> MediaStreamTrack:
        """Return a track for one viewer, who must take its pictures at once: they wait without a bound."""
        return self._relay.subscribe(self._track)

    async def close(self) -> None:
        """Close the camera; its thread may wait for a packet, so that another thread waits for its end."""
        self._track._player = None  # noqa: SLF001 (else `stop` would wait in the event loop)
        self._track.stop()
        await asyncio.to_thread(self._player._stop, self._track)  # noqa: SLF001


async def open_source(address: CameraAddress, *, passes_h264: bool) -> CameraSource:
    """Open a camera.

    Args:
        address: The address.
        passes_h264: True if the viewers play H.264.

    Returns:
        The open camera.

    Raises:
        LinkError: It does not answer, or sends no video.
    """
    try:
        return await asyncio.to_thread(_open, address, passes_h264)
    except (OSError, ValueError, av.FFmpegError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LinkError(f"opening the camera failed: {reason}") from None


def _open(address: CameraAddress, passes_h264: bool) -> CameraSource:
    if passes_h264:
        player = _player(address, decode=False)
        # The player passes on packets of VP8 too, which would be taken for H.264.
        if player.video is not None and _codec_of(player) == _H264:
            return CameraSource(player, player.video, _H264)
        _close(player)
    player = _player(address, decode=True)
    if player.video is None:
        _close(player)
        raise LinkError("opening the camera failed: it sends no video")
    return CameraSource(player, player.video, "")


def _player(address: CameraAddress, *, decode: bool) -> MediaPlayer:
    options = _OPTIONS if decode else _OPTIONS | _NO_BUFFER
    if address.url:
        return MediaPlayer(address.url, options=options | _RTSP, timeout=OPEN_TIMEOUT, decode=decode)
    with NamedTemporaryFile("w", suffix=".sdp", delete=False, encoding="ascii") as file:
        file.write(address.description)
    try:
        return MediaPlayer(
            file.name, format="sdp", options=options | _RTP, timeout=OPEN_TIMEOUT, decode=decode
        )
    finally:
        Path(file.name).unlink()


def _codec_of(player: Any) -> str:  # noqa: ANN401 (of aiortc, which has no call for it)
    name: str = player._MediaPlayer__container.streams.video[0].codec_context.name  # noqa: SLF001
    return name


def _close(player: Any) -> None:  # noqa: ANN401 - of aiortc, which has no call for it
    with suppress(AttributeError):
        player._MediaPlayer__container.close()  # noqa: SLF001
