"""A vehicle, its pilot and an attacker around one router, over real sockets."""

from __future__ import annotations

import socket
from contextlib import ExitStack, contextmanager
from time import monotonic, time
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.wire import Encoder, Parser
from tools.attacks.routers import CONFIG, KEY, Ports, RouterProgram

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from mavstack.dialects import Message
    from mavstack.wire import Packet

#: Seconds to wait for packets that should not come.
SILENCE: Final = 0.4
#: Seconds to wait for a packet that should come, and attempts.
_ANSWER_TIMEOUT: Final = 2.0
_ARRIVAL_TIMEOUT: Final = 10.0
_ATTEMPTS: Final = 4
#: Seconds to wait for a packet that is timed, and its time if it does not come.
_LOST: Final = 1.0
#: Messages that routers and ground stations send by themselves.
_OWN: Final = frozenset({"HEARTBEAT", "STATUSTEXT", "REQUEST_DATA_STREAM", "TIMESYNC", "PARAM_REQUEST_LIST"})
ARM: Final = common.MavCmd.COMPONENT_ARM_DISARM


class Station:
    """A program with a UDP socket: vehicle, pilot or attacker.

    Args:
        port: The router's port that it sends to.
        source: Its system and component id.
        own_port: Its own port; 0: any.
        signed: It signs its packets.
        version: Its MAVLink version.
    """

    def __init__(
        self, port: int, source: tuple[int, int], *, own_port: int = 0, signed: bool = False, version: int = 2
    ) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", own_port))
        self.socket.settimeout(SILENCE)
        self.sent: list[bytes] = []
        self.router = ("127.0.0.1", port)
        self.encoder = Encoder(*source, signing=KEY.signing() if signed else None, version=version)
        self.parser = Parser(common)

    def send(self, *messages: Message) -> None:
        """Send messages."""
        for message in messages:
            self.send_raw(self.encoder.encode(message, time()))

    def send_raw(self, data: bytes) -> None:
        """Send the bytes of a packet."""
        self.sent.append(data)
        self.socket.sendto(data, self.router)

    def receive(self, seconds: float = SILENCE) -> list[Packet]:
        """Return the packets that arrive until nothing arrives for a time."""
        packets: list[Packet] = []
        end = monotonic() + 5
        self.socket.settimeout(seconds)
        try:
            while monotonic() < end:
                packets += self.parser.feed(self.socket.recv(4096))
        except TimeoutError:
            pass
        return packets

    def next_is(self, name: str) -> bool:
        """Wait for a message that others may precede, such as heartbeats; return whether it came."""
        end = monotonic() + _LOST
        while (left := end - monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                packets = self.parser.feed(self.socket.recv(4096))
            except TimeoutError:
                return False
            if any(packet.name == name for packet in packets):
                return True
        return False

    def heartbeat(self) -> None:
        """Send a heartbeat, by which routers learn a route."""
        self.send(common.Heartbeat(type=common.MavType.GCS, autopilot=common.MavAutopilot.INVALID))


class Range:
    """A router with a vehicle and its pilot, who have heard of each other.

    Args:
        ports: The ports of the router.
        stack: Closes the sockets.
        folder: The folder of the router's files.
        signed: The pilot signs.
    """

    def __init__(self, ports: Ports, stack: ExitStack, folder: Path, *, signed: bool = True) -> None:
        self.ports = ports
        self.config = folder / CONFIG
        self._stack = stack
        self.vehicle = self._keep(Station(ports.vehicle, (1, 1)))
        self.pilot = self._keep(Station(ports.ground, (255, 190), own_port=ports.pilot, signed=signed))
        for _ in range(3):
            self.vehicle_heartbeat()
            self.pilot.heartbeat()
            self.pilot.receive(0.2)
            # A vehicle that answers may get more than three times what it sent.
            self.vehicle.send(common.CommandAck(command=512))
        self.vehicle.receive()

    def vehicle_heartbeat(self) -> None:
        """Send a heartbeat of the vehicle."""
        self.vehicle.send(common.Heartbeat(type=2, autopilot=common.MavAutopilot.PX4))

    def attacker(self, source: tuple[int, int] = (255, 190), *, version: int = 2) -> Station:
        """Return another program on the ground side, without the key."""
        return self._keep(Station(self.ports.ground, source, version=version))

    def attacker_of_vehicle(self, source: tuple[int, int]) -> Station:
        """Return another program on the port of the vehicle."""
        return self._keep(Station(self.ports.vehicle, source))

    def attacker_elsewhere(self, source: tuple[int, int]) -> Station:
        """Return another program on a third endpoint, of routers without a firewall."""
        return self._keep(Station(self.ports.other, source))

    def passed(self, expected: int = 0) -> int:
        """Return the number of packets that reached the vehicle, without those of the router itself.

        Args:
            expected: Packets that should come. A busy machine delivers them late, so fewer are waited for.
        """
        end = monotonic() + _ARRIVAL_TIMEOUT
        count = self._count_passed()
        while count < expected and monotonic() < end:
            count += self._count_passed()
        return count

    def _count_passed(self) -> int:
        return sum(packet.name not in _OWN for packet in self.vehicle.receive())

    def command_works(self) -> bool:
        """Return whether a command of the pilot reaches the vehicle; a busy machine needs seconds."""
        self.vehicle.receive(0.05)
        command = common.CommandLong(target_system=1, target_component=1, command=ARM, param1=1)
        for _ in range(_ATTEMPTS):
            self.pilot.send(command)
            if any(packet.name == "COMMAND_LONG" for packet in self.vehicle.receive(_ANSWER_TIMEOUT)):
                self.vehicle.receive()
                return True
            self.pilot.heartbeat()
        return False

    def acknowledge_delays(self, count: int) -> list[float]:
        """Return the times from the pilot's commands to their acknowledgements, in seconds."""
        delays = []
        for _ in range(count):
            begun = monotonic()
            self.pilot.send(common.CommandLong(target_system=1, target_component=1, command=512))
            arrived = self.vehicle.next_is("COMMAND_LONG")
            if arrived:
                self.vehicle.send(common.CommandAck(command=512, target_system=255, target_component=190))
                arrived = self.pilot.next_is("COMMAND_ACK")
            delays.append(monotonic() - begun if arrived else _LOST)
        return delays

    def telemetry_delays(self, count: int) -> list[float]:
        """Return the times that packets of telemetry need from the vehicle to the pilot, in seconds."""
        delays = []
        for number in range(count):
            begun = monotonic()
            self.vehicle.send(common.Attitude(time_boot_ms=number))
            delays.append(monotonic() - begun if self.pilot.next_is("ATTITUDE") else _LOST)
        return delays

    def _keep(self, station: Station) -> Station:
        self._stack.callback(station.socket.close)
        return station


@contextmanager
def opened(program: RouterProgram, *, signed: bool = True) -> Iterator[Range]:
    """Run a router with a vehicle and a pilot.

    Args:
        program: The router.
        signed: The pilot signs.

    Yields:
        The range.
    """
    ports = Ports.free()
    with program.running(ports) as folder, ExitStack() as stack:
        yield Range(ports, stack, folder, signed=signed)
