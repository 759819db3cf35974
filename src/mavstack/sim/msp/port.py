"""The port of a flight controller: its end of the connection to one peer.

A port answers MSP frames. A `#` between frames opens the command line interface a tenth of a second later,
unless a frame follows before; then all bytes are text until `exit` or `save`. A passthrough connects the
port to a device until its peer leaves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

from mavstack.msp.frame import NO_REPLY, Direction, Frame, FrameVersion
from mavstack.msp.parser import FrameParser
from mavstack.sim.msp.command_line import CommandLine

if TYPE_CHECKING:
    from mavstack.sim.msp.controller import SimulatedFlightController

#: Seconds after a received `#` until the command line interface opens.
CLI_GUARD: Final = 0.1
#: Maximum bytes of output that a peer has not read; as on a serial port, further output is dropped.
MAX_PENDING: Final = 1 << 18
_HASH: Final = b"#"


class Device(Protocol):
    """A device behind a passthrough, such as a GPS receiver."""

    def data_to_send(self, now: float) -> bytes:
        """Return what the device has sent up to a time."""


class MspPort:
    """The connection of a flight controller to one peer.

    Args:
        name: The name of the peer.
        host: The controller.
        honours_no_reply: The firmware honours the flag `NO_REPLY`.
    """

    def __init__(self, name: str, host: SimulatedFlightController, *, honours_no_reply: bool) -> None:
        self.name = name
        self._host, self._honours_no_reply = host, honours_no_reply
        self._output = bytearray()
        self.restart()

    def restart(self) -> None:
        """Forget everything but the output, as at a boot."""
        self._parser = FrameParser()
        self._cli: CommandLine | None = None
        self._cli_due: float | None = None
        self.passthrough: Device | None = None

    def limit(self, bandwidth: float | None, bulk_rate: float | None) -> None:
        """Do nothing: a flight controller only answers."""

    @property
    def has_cli(self) -> bool:
        """True while the peer uses the command line interface."""
        return self._cli is not None

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of the peer."""
        if self._cli is not None:
            self._send(self._cli.feed(data))
        elif self.passthrough is None:
            self._receive_frames(data, now)

    def _receive_frames(self, data: bytes, now: float) -> None:
        parser = self._parser
        frames = parser.feed(data)
        text = parser.take_text()
        if frames:
            self._cli_due = None
        for frame in frames:
            if frame.direction is Direction.REQUEST:
                self._answer(frame)
        if _HASH in text and not frames:
            self._cli_due = now + CLI_GUARD

    def _answer(self, frame: Frame) -> None:
        payload = self._host.answer(frame, self)
        if frame.flags & NO_REPLY and self._honours_no_reply:
            return
        direction = Direction.ERROR if payload is None else Direction.RESPONSE
        version = FrameVersion.V1 if frame.version is FrameVersion.JUMBO else frame.version
        self._send(Frame(frame.command, payload or b"", direction, version).encode())

    def step(self, now: float) -> None:
        """Advance to a time."""
        if self._cli_due is not None and now >= self._cli_due:
            self._cli_due = None
            self._host.cli_entered()
            self._cli = CommandLine(self._host.cli_commands)
            self._send(self._cli.greeting())
        if self.passthrough is not None:
            self._send(self.passthrough.data_to_send(now))

    def _send(self, data: bytes) -> None:
        if len(self._output) + len(data) <= MAX_PENDING:
            self._output += data

    def take_output(self) -> bytes:
        """Return the bytes for the peer since the last call."""
        data = bytes(self._output)
        self._output.clear()
        return data
