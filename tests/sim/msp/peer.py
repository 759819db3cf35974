"""A peer of a simulated flight controller in virtual time: requests, a transmitter, and the CLI.

peer = Peer("betaflight")
peer.transmit(throttle=1000, seconds=6)        # frames of a transmitter, 50 a second
assert peer.get(StatusEx).arming_disable_reasons == ()
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.msp import Direction, Frame, FrameParser, FrameVersion
from mavstack.msp.messages.rc import SetRawRc
from mavstack.sim import Simulation

if TYPE_CHECKING:
    from mavstack.msp.messages import MspMessage

AnyMessage = TypeVar("AnyMessage", bound="MspMessage")

#: Pulse widths of switches.
LOW, MIDDLE, HIGH = 1000, 1500, 1900


class Peer:
    """A flight controller, and a peer at one of its ports."""

    def __init__(self, firmware: str = "betaflight", **options: Any) -> None:
        self.simulation = Simulation(**options)
        self.controller = self.simulation.add_flight_controller(firmware)
        self.events: list[tuple[str, str]] = []
        self.controller.add_listener(lambda _, kind, text: self.events.append((kind, text)))
        self.aux = [LOW] * 6
        self.connect()

    def connect(self) -> None:
        """Open a new port."""
        self.port = self.controller.open_port("test")
        self._parser = FrameParser()

    def run(self, seconds: float) -> None:
        """Let time pass without a transmitter."""
        self.simulation.advance(self.simulation.now + seconds)

    def output(self) -> bytes:
        """Return what the port has sent."""
        return b"".join(data for port, data in self.controller.data_to_send() if port is self.port)

    def send(self, data: bytes) -> bytes:
        """Send bytes, and return the answer."""
        self.controller.receive(self.port, data)
        return self.output()

    def request(
        self, command: int, payload: bytes = b"", version: FrameVersion = FrameVersion.V2
    ) -> Frame | None:
        """Send a request, and return the reply; None if there is none."""
        replies = self._parser.feed(self.send(Frame(int(command), payload, version=version).encode()))
        return replies[-1] if replies else None

    def get(self, kind: type[AnyMessage], payload: bytes = b"") -> AnyMessage:
        """Return a message of the controller."""
        reply = self.request(kind.COMMAND, payload)
        assert reply is not None
        assert reply.direction is Direction.RESPONSE, kind.NAME
        return kind.decode(reply.payload, self.controller.info)

    def write(self, message: MspMessage) -> bool:
        """Send a message; returns whether it was accepted."""
        reply = self.request(message.COMMAND, message.encode(self.controller.info))
        assert reply is not None
        return reply.direction is Direction.RESPONSE

    def transmit(
        self, seconds: float, *, throttle: int = LOW, roll: int = 1500, pitch: int = 1500, yaw: int = 1500
    ) -> None:
        """Send frames of a transmitter, with the switches of `aux`."""
        frame = SetRawRc((roll, pitch, throttle, yaw, *self.aux)).encode()
        for _ in range(round(seconds * 50)):
            self.controller.receive(self.port, Frame(SetRawRc.COMMAND, frame).encode())
            self.simulation.step()
        self.output()

    def arm(self) -> None:
        """Wait until the controller can be armed, and arm it."""
        self.transmit(6.0)
        self.aux[0] = HIGH
        self.transmit(0.1)
        assert self.controller.armed, self.controller.arming_disable_reasons

    def texts(self, kind: str) -> list[str]:
        """Return the events of a kind."""
        return [text for each, text in self.events if each == kind]

    def enter_cli(self) -> str:
        """Enter the command line interface."""
        self.send(b"#")
        self.run(0.2)
        return self.output().decode()

    def cli(self, line: str) -> str:
        """Type a line, and return the answer without echo and prompt."""
        answer = self.send(f"{line}\n".encode()).decode().replace("\r\n", "\n")
        return answer.removeprefix(f"{line}\n").removesuffix("\n# ")
