"""One file of recorded video: MP4 in fragments, so that a file of a program that was killed can be played.

H.264 is written as the camera made it; pictures that were decoded are encoded.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from mavstack.errors import LogError, MissingExtraError
from mavstack.server.video.nal_units import PARAMETER_SETS, SLICES, unit_types

try:
    import av
except ImportError as missing:
    raise MissingExtraError("recording of video", "video") from missing

if TYPE_CHECKING:
    from pathlib import Path

    from av.container import OutputContainer
    from av.video.stream import VideoStream

_OPTIONS: Final = {
    "movflags": "frag_keyframe+empty_moov+delay_moov+default_base_moof",
    "flush_packets": "1",
}
_ENCODER: Final = {"preset": "veryfast", "tune": "zerolatency", "crf": "23"}
#: Pictures per second that the encoder assumes; the times of the pictures are those of the camera.
_RATE: Final = 30
_TIME_BASE: Final = Fraction(1, 90_000)
#: Number of pictures between two that need no other: a file is cut only there.
_KEY_INTERVAL: Final = 60


class VideoFile:
    """A file that grows; its methods wait for the disk.

    Args:
        path: The file, which exists and is empty. It is removed if no picture comes.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._container: OutputContainer | None = None
        self._stream: VideoStream | None = None
        #: The time of the first picture: a camera counts from its opening, which may be long ago.
        self._first = 0
        self._last = -1
        self._needs_key = True
        #: Seconds of video in the file, and the number of packets that were left out: the damaged ones, and
        #: the ones after them that need them.
        self.seconds = 0.0
        self.damaged = 0

    def write(self, data: av.Packet[av.VideoStream] | av.VideoFrame) -> None:
        """Append a packet of H.264, or a picture; damaged packets are left out, with the ones that need them.

        Raises:
            LogError: The file cannot be written.
        """
        try:
            if isinstance(data, av.Packet):
                self._write_packet(data)
            else:
                self._write_picture(data)
        except (OSError, ValueError, av.FFmpegError) as error:
            raise self._failure(error) from None

    def close(self) -> None:
        """Complete the file. Idempotent.

        Raises:
            LogError: The file cannot be written.
        """
        container, self._container = self._container, None
        if container is None:
            self._remove_empty()
            return
        try:
            if self._stream is not None and self._stream.codec_context.is_open:
                self._mux_encoded(container, self._stream.encode(None))
            container.close()
        except (OSError, ValueError, av.FFmpegError) as error:
            raise self._failure(error) from None

    def _write_packet(self, packet: av.Packet[av.VideoStream]) -> None:
        data = bytes(packet)  # a copy: the packet belongs to the viewers too
        types = unit_types(data)
        if packet.pts is None or types.isdisjoint(SLICES):
            # The muxer accepts any bytes, and a file that begins with damaged ones cannot be opened.
            self.damaged += 1
            self._needs_key = True
            return
        if self._needs_key and not _can_begin(packet, types):
            self.damaged += self._container is not None
            return
        self._needs_key = False
        if self._container is None or self._stream is None:
            self._container = self._open()
            self._stream = self._container.add_stream_from_template(packet.stream)
            self._first = packet.pts
        copy = av.Packet(data)
        self._last = max(self._last + 1, packet.pts - self._first)
        copy.pts = copy.dts = self._last
        copy.time_base, copy.is_keyframe, copy.stream = packet.time_base, packet.is_keyframe, self._stream
        self.seconds = float(self._last * packet.time_base)
        self._container.mux(copy)

    def _write_picture(self, frame: av.VideoFrame) -> None:
        if self._container is None:
            self._container = self._open()
            self._stream = self._container.add_stream("libx264", rate=_RATE, options=_ENCODER)
            self._stream.width, self._stream.height = frame.width, frame.height
            self._stream.pix_fmt, self._stream.gop_size = "yuv420p", _KEY_INTERVAL
            self._stream.codec_context.time_base = frame.time_base or _TIME_BASE
            self._first = frame.pts or 0
        if self._stream is None or frame.pts is None or frame.pts - self._first <= self._last:
            return
        self._last = frame.pts - self._first
        self.seconds = float(self._last * (frame.time_base or _TIME_BASE))
        copy = frame.reformat(format="yuv420p") if frame.format.name != "yuv420p" else frame
        copy.pict_type = av.video.frame.PictureType.NONE  # the encoder chooses
        self._mux_encoded(self._container, self._stream.encode(copy))

    def _mux_encoded(self, container: OutputContainer, packets: list[av.Packet[av.VideoStream]]) -> None:
        # The pictures belong to the viewers too, so that the times are moved here.
        for packet in packets:
            packet.pts, packet.dts = (packet.pts or 0) - self._first, (packet.dts or 0) - self._first
            container.mux(packet)

    def _open(self) -> OutputContainer:
        return av.open(str(self._path), "w", format="mp4", options=_OPTIONS)

    def _remove_empty(self) -> None:
        with suppress(OSError):
            if self._path.stat().st_size == 0:
                self._path.unlink()

    def _failure(self, error: Exception) -> LogError:
        reason = getattr(error, "strerror", None) or str(error)
        return LogError(f"writing {self._path.name} failed: {reason}")


def _can_begin(packet: av.Packet[av.VideoStream], types: frozenset[int]) -> bool:
    """Return whether a packet needs no other, and its parameter sets are known."""
    known = types | unit_types(packet.stream.codec_context.extradata or b"")
    return bool(packet.is_keyframe) and known >= PARAMETER_SETS
