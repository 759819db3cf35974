"""The video of a simulated camera: an RTSP server that encodes H.264 while there are players.

    async with VideoCamera(lambda: draw(time(), roll, pitch)) as camera:
        ...  # camera.url, such as rtsp://127.0.0.1:8554/camera

It speaks the part of RTSP that players need (RFC 2326: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN), with RTP
inside of the connection; a player that asks for UDP is refused with 461 and asks again. The extra `video` is
needed.
"""

from __future__ import annotations

import asyncio
import re
from contextlib import suppress
from fractions import Fraction
from secrets import randbelow, token_hex
from time import time
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkError, MissingExtraError

try:
    import av
    from aiortc.codecs.h264 import H264Encoder
except ImportError as missing:
    raise MissingExtraError("the video of a simulated camera", "video") from missing

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Self

    import numpy as np
    from numpy.typing import NDArray

#: Pictures per second, and the clock rate of RTP in hertz.
RATE: Final = 20
_CLOCK: Final = 90_000
_PAYLOAD_TYPE: Final = 96
#: Maximum number of players at the same time, and maximum bytes of a request.
MAX_PLAYERS: Final = 8
_MAX_REQUEST: Final = 8192
#: Maximum bytes that wait for a player; while there are more, pictures are skipped.
_MAX_BACKLOG: Final = 1 << 19
_REQUEST: Final = re.compile(r"(?P<method>[A-Z_]{3,20}) (?P<url>\S{1,512}) RTSP/1\.0\r\n")
_SEQUENCE: Final = re.compile(r"^CSeq: *(\d{1,9})\r$", re.MULTILINE | re.IGNORECASE)
_DESCRIPTION: Final = (
    "v=0\r\no=- 1 1 IN IP4 127.0.0.1\r\ns=Simulated camera\r\nc=IN IP4 0.0.0.0\r\nt=0 0\r\na=control:*\r\n"
    f"m=video 0 RTP/AVP {_PAYLOAD_TYPE}\r\na=rtpmap:{_PAYLOAD_TYPE} H264/{_CLOCK}\r\n"
    f"a=fmtp:{_PAYLOAD_TYPE} packetization-mode=1\r\na=control:track0\r\n"
)


class VideoCamera:
    """The RTSP server of one camera.

    Args:
        draw: Returns the present picture: rows, columns and RGB.
        host: The address to listen on.
        port: The port; 0: the system chooses one.
    """

    def __init__(
        self, draw: Callable[[], NDArray[np.uint8]], *, host: str = "127.0.0.1", port: int = 0
    ) -> None:
        self._draw, self._host, self._port = draw, host, port
        self._players: dict[asyncio.StreamWriter, int] = {}
        self._server: asyncio.Server | None = None
        self._task: asyncio.Task[None] | None = None
        self._connections: set[asyncio.StreamWriter] = set()
        self._has_players = asyncio.Event()
        self._sequence, self._source = randbelow(1 << 16), randbelow(1 << 32)

    @property
    def url(self) -> str:
        """The address of the stream."""
        return f"rtsp://{self._host}:{self._port}/camera"

    @property
    def players(self) -> int:
        """Number of players that get pictures."""
        return len(self._players)

    async def __aenter__(self) -> Self:
        try:
            self._server = await asyncio.start_server(self._serve, self._host, self._port, limit=_MAX_REQUEST)
        except OSError as error:
            raise LinkError(f"listening on {self._host}:{self._port} failed: {error.strerror}") from error
        self._port = self._server.sockets[0].getsockname()[1]
        self._task = asyncio.get_running_loop().create_task(self._film())
        return self

    async def __aexit__(self, *_: object) -> None:
        if self._server is None or self._task is None:
            return
        self._task.cancel()
        self._server.close()
        for writer in tuple(self._connections):
            writer.close()
        await asyncio.gather(self._task, return_exceptions=True)
        await self._server.wait_closed()

    async def _film(self) -> None:
        """Encode and send pictures while there are players."""
        while True:
            await self._has_players.wait()
            encoder, packer, started = _new_encoder(), H264Encoder(), asyncio.get_running_loop().time()
            count = 0
            while self._players:
                frame = av.VideoFrame.from_ndarray(self._draw(), format="rgb24")
                frame.pts, frame.time_base = count, Fraction(1, RATE)
                for packet in await asyncio.to_thread(encoder.encode, frame):
                    payloads, timestamp = packer.pack(packet)
                    self._send(payloads, timestamp)
                count += 1
                delay = started + count / RATE - asyncio.get_running_loop().time()
                await asyncio.sleep(max(0.0, delay))
            self._has_players.clear()

    def _send(self, payloads: list[bytes], timestamp: int) -> None:
        frames = []
        for index, payload in enumerate(payloads):
            self._sequence = (self._sequence + 1) % (1 << 16)
            marker = 0x80 * (index == len(payloads) - 1)
            header = bytes((0x80, _PAYLOAD_TYPE | marker)) + self._sequence.to_bytes(2, "big")
            header += (timestamp % (1 << 32)).to_bytes(4, "big") + self._source.to_bytes(4, "big")
            frames.append(header + payload)
        for writer, channel in self._players.items():
            if writer.transport.get_write_buffer_size() < _MAX_BACKLOG:
                prefix = bytes((0x24, channel))
                writer.writelines(prefix + len(each).to_bytes(2, "big") + each for each in frames)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._connections.add(writer)
        session, channel = token_hex(8), 0
        with suppress(OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, ValueError):
            while len(self._connections) <= MAX_PLAYERS:
                text = await _read_request(reader)
                request, number = _REQUEST.match(text), _SEQUENCE.search(text)
                if request is None or number is None:
                    break
                channel = _channel_of(text, channel)
                status, extra, body = _answer(request["method"], request["url"], text, session, channel)
                writer.write(f"RTSP/1.0 {status}\r\nCSeq: {number[1]}\r\n{extra}\r\n{body}".encode())
                if request["method"] == "PLAY":
                    self._players[writer] = channel
                    self._has_players.set()
                elif request["method"] == "TEARDOWN":
                    break
        self._players.pop(writer, None)
        self._connections.discard(writer)
        writer.close()


async def _read_request(reader: asyncio.StreamReader) -> str:
    """Return the next request without the reports of RTCP before it."""
    while True:
        first = await reader.readexactly(1)
        if first != b"$":
            return (first + await reader.readuntil(b"\r\n\r\n")).decode("ascii")
        header = await reader.readexactly(3)
        await reader.readexactly(int.from_bytes(header[1:], "big"))


def _channel_of(text: str, default: int) -> int:
    found = re.search(r"interleaved=(\d{1,3})-", text)
    return int(found[1]) if found is not None and int(found[1]) < (1 << 8) else default


def _answer(method: str, url: str, text: str, session: str, channel: int) -> tuple[str, str, str]:
    """Return status, headers and body of the answer to a request."""
    match method:
        case "OPTIONS":
            return "200 OK", "Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN, GET_PARAMETER\r\n", ""
        case "DESCRIBE":
            headers = f"Content-Base: {url.rstrip('/')}/\r\nContent-Type: application/sdp\r\n"
            return "200 OK", f"{headers}Content-Length: {len(_DESCRIPTION)}\r\n", _DESCRIPTION
        case "SETUP" if "RTP/AVP/TCP" not in text:
            return "461 Unsupported Transport", "", ""
        case "SETUP":
            transport = f"RTP/AVP/TCP;unicast;interleaved={channel}-{channel + 1}"
            return "200 OK", f"Transport: {transport}\r\nSession: {session};timeout=60\r\n", ""
        case "PLAY" | "TEARDOWN" | "GET_PARAMETER":
            return "200 OK", f"Session: {session}\r\n", ""
    return "501 Not Implemented", "", ""


def _new_encoder() -> av.VideoCodecContext:
    from mavstack.sim.payloads.picture import HEIGHT, WIDTH

    encoder = av.CodecContext.create("libx264", "w")
    encoder.width, encoder.height = WIDTH, HEIGHT
    encoder.pix_fmt, encoder.time_base, encoder.framerate = "yuv420p", Fraction(1, RATE), Fraction(RATE)
    encoder.gop_size = RATE // 2
    encoder.options = {"preset": "ultrafast", "tune": "zerolatency", "profile": "baseline", "crf": "28"}
    encoder.max_b_frames = 0
    return encoder


def attitude_picture(attitude: Callable[[], tuple[float, float]]) -> Callable[[], NDArray[np.uint8]]:
    """Return a function that draws the present time and an attitude.

    Args:
        attitude: Returns roll and pitch in radians.

    Returns:
        The function.
    """
    from mavstack.sim.payloads.picture import draw

    return lambda: draw(time(), *attitude())
