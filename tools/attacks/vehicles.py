"""Attacks on a simulated vehicle (`mav sim`) itself: its FTP sessions, and the pace of its link."""

from __future__ import annotations

import socket
import tempfile
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from time import monotonic, time
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.ftp import FtpPayload, Opcode
from mavstack.wire import Encoder, Parser
from tools.attacks.routers import KEY
from tools.attacks.station import running_program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from mavstack.dialects import Message
    from mavstack.wire import Packet

_START_TIMEOUT: Final = 60.0
#: FTP clients that keep reading, and seconds in which another one gets a session.
_READERS: Final = 16
_SESSION_TIMEOUT: Final = 20.0
_READ_SIZE: Final = 80
_FILE: Final = b"@PARAM/param.pck"
#: Seconds of telemetry that are compared, and forged reports before.
_SAMPLE: Final = 3.0
_REPORTS: Final = 40


class Program:
    """A program on a UDP port that speaks to the vehicle.

    Args:
        port: The port of the vehicle.
        system: Its system id.
        signed: It signs.
    """

    def __init__(self, port: int, system: int, *, signed: bool = False) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", port))
        self._encoder = Encoder(system, 190, signing=KEY.signing() if signed else None)
        self._plain, self._parser, self._number = Encoder(51, 68), Parser(common), 0
        self.close = self._socket.close

    def send(self, message: Message) -> None:
        """Send a message."""
        with suppress(OSError):  # the port is not open yet
            self._socket.send(self._encoder.encode(message, time()))

    def send_report(self) -> None:
        """Send RADIO_STATUS with a full queue as a radio, unsigned."""
        self._socket.send(self._plain.encode(common.RadioStatus(txbuf=0, rssi=100, remrssi=100)))

    def receive(self, seconds: float) -> list[Packet]:
        """Return the packets of a time, and send heartbeats meanwhile."""
        packets: list[Packet] = []
        end, self._number = monotonic() + seconds, self._number + 1
        self.send(common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID))
        while (left := end - monotonic()) > 0:
            self._socket.settimeout(left)
            with suppress(OSError):
                packets += self._parser.feed(self._socket.recv(4096))
        return packets

    def ask_ftp(self, opcode: Opcode, data: bytes = b"", session: int = 0) -> FtpPayload | None:
        """Send a request of the FTP, and return the answer."""
        self._number += 1
        size = len(data) or _READ_SIZE
        request = FtpPayload.request(opcode, data, session=session, size=size).numbered(self._number)
        self.send(request.to_message(1, 1))
        found = (packet for packet in self.receive(0.1) if packet.name == "FILE_TRANSFER_PROTOCOL")
        return next((FtpPayload.read(packet.message) for packet in found), None)


@contextmanager
def _vehicle(query: str = "") -> Iterator[int]:
    """Run a simulated vehicle; yield its port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with running_program("sim", "--out", f"udpin://127.0.0.1:{port}{query}", "--json"):
        yield port


def _wait_for(program: Program) -> None:
    end = monotonic() + _START_TIMEOUT
    while not program.receive(0.5):
        if monotonic() > end:
            raise SystemExit("mavstack: the simulated vehicle does not answer")


def ftp_sessions() -> int:
    """Keep 16 files open and read; return 1 if another client gets no session."""
    with _vehicle() as port, ExitStack() as stack:
        pilot = Program(port, 255)
        stack.callback(pilot.close)
        _wait_for(pilot)
        sessions: dict[Program, int] = {}
        for number in range(_READERS):
            reader = Program(port, 100 + number)
            stack.callback(reader.close)
            answer = reader.ask_ftp(Opcode.OPENFILERO, _FILE)
            sessions[reader] = 0 if answer is None else answer.session
        end = monotonic() + _SESSION_TIMEOUT
        while monotonic() < end:
            for reader, session in sessions.items():
                reader.ask_ftp(Opcode.READFILE, session=session)
            answer = pilot.ask_ftp(Opcode.OPENFILERO, _FILE)
            if answer is not None and answer.opcode == Opcode.ACK:
                return 0
    return 1


def forged_radio_status() -> int:
    """Report a full queue unsigned on a link that signs; return 1 if telemetry halves."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        key = Path(folder) / "field.key"
        KEY.save(key)
        port = stack.enter_context(_vehicle(f"?signing_key={key}"))
        pilot = Program(port, 255, signed=True)
        stack.callback(pilot.close)
        _wait_for(pilot)
        pilot.receive(_SAMPLE)  # until the streams run
        before = len(pilot.receive(_SAMPLE))
        for _ in range(_REPORTS):
            pilot.send_report()
            pilot.receive(0.1)
        after = len(pilot.receive(_SAMPLE))
    if not before:
        raise SystemExit("mavstack: the simulated vehicle sends no telemetry")
    return int(after < before / 2)


#: Attacks on a vehicle, by their names in the table.
VEHICLES: Final[Mapping[str, Callable[[], int]]] = MappingProxyType(
    {
        "FTP: 16 readers lock the pilot out": ftp_sessions,
        "RADIO_STATUS unsigned, on a link that signs": forged_radio_status,
    }
)
