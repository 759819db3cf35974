"""The attacks: each returns the number of packets that should not have passed, or milliseconds."""

from __future__ import annotations

import threading
from statistics import median, pstdev
from time import monotonic, sleep, time
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.security.redaction import strip_signature
from mavstack.wire import Encoder, Packet
from tools.attacks.range import ARM

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.dialects import Message
    from tools.attacks.range import Range, Station

#: Commands whose acknowledgement is timed.
_COMMANDS: Final = 40
#: Ports of an attacker.
_PORTS: Final = 300
#: Seconds of a flood that should have the pilot cut off.
_FLOOD_TIME: Final = 2.0
#: Packets of telemetry that are timed.
_TELEMETRY: Final = 200


def eavesdropping(field: Range) -> int:
    """Let an unknown program join, and count the telemetry that it gets."""
    attacker = field.attacker((200, 190))
    attacker.heartbeat()
    attacker.receive(0.1)
    for _ in range(10):
        field.vehicle.send(common.GlobalPositionInt(lat=1, lon=2))
    return sum(packet.name == "GLOBAL_POSITION_INT" for packet in attacker.receive())


def injection(field: Range) -> int:
    """Arm and disarm with MAVLink 1 and with unsigned MAVLink 2, with the pilot's ids."""
    for version in (1, 2):
        attacker = field.attacker(version=version)
        for value in (1, 0):
            attacker.send(common.CommandLong(target_system=1, target_component=1, command=ARM, param1=value))
    return field.passed()


def altered_waypoints(field: Range) -> int:
    """Upload a mission of one's own, in MAVLink 1."""
    _upload(field.attacker(version=1))
    return field.passed()


def man_in_the_middle(field: Range) -> int:
    """Change a byte of the pilot's signed commands on their way; and remove the signature."""
    encoder = field.pilot.encoder
    command = common.CommandLong(target_system=1, target_component=1, command=ARM)
    for _ in range(10):
        signed = encoder.encode(command, time())
        packet = Packet(signed, common)
        changed = bytearray(signed)
        changed[-1] ^= 1
        field.pilot.socket.sendto(bytes(changed), ("127.0.0.1", field.ports.ground))
        field.pilot.socket.sendto(strip_signature(packet), ("127.0.0.1", field.ports.ground))
    return field.passed()


def replay(field: Range) -> int:
    """Send the pilot's recorded, signed packets again, from the pilot's own address and from another."""
    field.command_works()
    recorded = field.pilot.sent[-1]
    attacker = field.attacker()
    for _ in range(5):
        attacker.send_raw(recorded)
        field.pilot.socket.sendto(recorded, ("127.0.0.1", field.ports.ground))
    return field.passed()


def spoofed_position(field: Range) -> int:
    """Send HIL_GPS and GPS_INPUT: unsigned, and by a pilot's station that was taken over, with its key."""
    attacker = field.attacker()
    for station in (attacker, field.pilot):
        station.send(common.HilGps(lat=1, lon=2), common.GpsInput(lat=1, lon=2))
    return field.passed()


def malformed(field: Range) -> int:
    """Send counts above their arrays, with the key."""
    field.pilot.send(
        common.TrajectoryRepresentationWaypoints(valid_points=200),
        common.SerialControl(count=255),
        common.Tunnel(target_system=1, payload_length=255),
    )
    return field.passed()


def malformed_by_dialect(field: Range) -> int:
    """Send counts above their arrays in messages of ArduPilot's own dialect, with the key."""
    field.pilot.send(
        ardupilotmega.Data16(len=255),
        ardupilotmega.Data96(len=255),
        ardupilotmega.DeviceOpWrite(target_system=1, target_component=1, count=255),
    )
    return field.passed()


def id_hijack(field: Range) -> int:
    """Claim the vehicle's id, and count the pilot's commands that come to the attacker."""
    attacker = field.attacker((1, 1))
    for _ in range(3):
        attacker.heartbeat()
    attacker.receive(0.1)
    field.pilot.send(common.CommandLong(target_system=1, target_component=1, command=ARM))
    return sum(packet.name == "COMMAND_LONG" for packet in attacker.receive())


def setup_signing(field: Range) -> int:
    """Send a key of one's own to the vehicle."""
    attacker = field.attacker()
    for station in (attacker, field.pilot):
        station.send(common.SetupSigning(target_system=1, target_component=1, secret_key=bytes(range(32))))
    return field.passed()


def flood(field: Range) -> dict[str, float]:
    """Send invalid packets without a pause.

    Args:
        field: The range.

    Returns:
        The delay that the flood adds to acknowledgements, and the jitter of telemetry without and with it, in
        milliseconds.
    """
    delay, jitter = _timed(field)
    attacker = field.attacker()
    broken = bytearray(Encoder(255, 190).encode(common.CommandLong(command=ARM)))
    broken[-1] ^= 0xFF
    end = threading.Event()
    thread = threading.Thread(target=_flood, args=(attacker, bytes(broken), end))
    thread.start()
    try:
        delay_under_flood, jitter_under_flood = _timed(field)
    finally:
        end.set()
        thread.join()
    values = (delay_under_flood - delay, jitter, jitter_under_flood)
    return {name: round(value * 1000, 2) for name, value in zip(FLOOD, values, strict=True)}


def many_ports(field: Range) -> int:
    """Send unsigned heartbeats from 300 ports; return 1 if the pilot is locked out."""
    for number in range(_PORTS):
        field.attacker((100 + number % 100, 190)).heartbeat()
    return int(not field.command_works())


def quarantine_as_a_weapon(field: Range) -> int:
    """Have the pilot cut off: a flood of unsigned datagrams, and malformed packets with the pilot's ids."""
    attacker = field.attacker()
    heartbeat = attacker.encoder.encode(common.Heartbeat(type=common.MavType.GCS))
    end = monotonic() + _FLOOD_TIME
    while monotonic() < end:
        for _ in range(50):
            attacker.send_raw(heartbeat)
        sleep(0.01)
    attacker.send(common.SerialControl(count=200))
    on_vehicle_port = field.attacker_of_vehicle((255, 190))
    on_vehicle_port.send(common.SerialControl(count=200))
    sleep(1.5)  # counters are looked at once a second
    return int(not field.command_works())


def stolen_route(field: Range) -> int:
    """Name oneself as the vehicle on its own port, and count the stripped commands of the pilot that come."""
    stranger = field.attacker_of_vehicle((1, 1))
    commands = 0
    for number in range(30):
        field.vehicle.send(common.Attitude(time_boot_ms=number))
        stranger.send(common.Attitude(time_boot_ms=number), common.CommandAck(command=ARM))
        field.pilot.send(common.CommandLong(target_system=1, target_component=1, command=ARM))
        if number % 10 == 9:
            commands += sum(packet.name == "COMMAND_LONG" for packet in stranger.receive(0.1))
    return commands


def stolen_route_by_any_message(field: Range) -> int:
    """Name oneself as the vehicle on a third endpoint, not by HEARTBEAT; count the commands that come."""
    stranger = field.attacker_elsewhere((1, 1))
    commands = 0
    for number in range(10):
        field.vehicle.send(common.Attitude(time_boot_ms=number))
        stranger.send(common.Attitude(time_boot_ms=number), common.CommandAck(command=ARM))
        field.pilot.send(common.CommandLong(target_system=1, target_component=1, command=ARM))
    commands += sum(packet.name == "COMMAND_LONG" for packet in stranger.receive())
    return commands


def reflection(field: Range) -> int:
    """Send two datagrams from a new address; count the bytes that come beyond three times those."""
    victim = field.attacker_of_vehicle((1, 200))
    victim.send(common.Attitude(), common.Attitude())
    for number in range(300):
        field.vehicle.send(common.Attitude(time_boot_ms=number))
    received = sum(len(packet.raw) for packet in victim.receive())
    return max(0, received - 3 * sum(map(len, victim.sent)))


def reflection_factor(field: Range) -> float:
    """Send two datagrams to the port of ground stations; return the bytes that come for each byte sent."""
    victim = field.attacker((200, 190))
    victim.send(common.Attitude(), common.Attitude())
    for number in range(300):
        field.vehicle.send(common.Attitude(time_boot_ms=number))
    received = sum(len(packet.raw) for packet in victim.receive())
    return round(received / sum(map(len, victim.sent)), 1)


def acting_in_the_pilots_name(field: Range) -> int:
    """Steer, upload and reconfigure with the pilot's ids from the vehicle's port, from a new address each."""
    for message in acting_messages():
        field.attacker_of_vehicle((255, 190)).send(message)
    return field.passed()


def beside_the_pilot(field: Range) -> int:
    """Send the same from other programs on the pilot's port, each time from a new address."""
    field.pilot.heartbeat()
    for message in acting_messages():
        field.attacker((255, 190)).send(message)
    return field.passed()


def malformed_in_the_pilots_name(field: Range) -> int:
    """Send malformed fields with the pilot's ids without signing; return 1 if the pilot is cut off."""
    field.attacker((255, 190)).send(common.SerialControl(count=200))
    sleep(1.5)
    return int(not field.command_works())


def acting_messages() -> list[Message]:
    """Return a message of each kind that acts upon a vehicle."""
    target = {"target_system": 1, "target_component": 1}
    return [
        common.CommandLong(**target, command=ARM, param1=1),
        common.SetMode(target_system=1, custom_mode=4),
        common.ParamSet(**target, param_id="FENCE_ENABLE", param_value=0.0),
        common.RcChannelsOverride(**target),
        common.ManualControl(target=1),
        common.SetPositionTargetLocalNed(**target),
        common.SetPositionTargetGlobalInt(**target),
        common.SetAttitudeTarget(target_system=1, target_component=1),
        common.SerialControl(count=1),
        common.MissionItem(**target),
        common.MissionItemInt(**target),
        common.ParamExtSet(target_system=1, target_component=1),
        common.LogErase(**target),
        common.SetHomePosition(target_system=1),
        common.FileTransferProtocol(target_system=1, target_component=1),
    ]


#: Attacks that count what passed, by their names in the table.
PASSED: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {
        "eavesdropping: telemetry of 10 heard": eavesdropping,
        "injection: arm, disarm (v1, unsigned)": injection,
        "altered waypoints (v1)": altered_waypoints,
        "man in the middle: altered, stripped": man_in_the_middle,
        "replay of signed commands": replay,
        "HIL_GPS, GPS_INPUT": spoofed_position,
        "counts above their arrays": malformed,
        "counts above their arrays, ArduPilot's messages": malformed_by_dialect,
        "id hijack: commands diverted": id_hijack,
        "SETUP_SIGNING through the router": setup_signing,
        "300 ports: pilots locked out": many_ports,
        "quarantine as a weapon: pilot cut off": quarantine_as_a_weapon,
        "stolen route: 30 commands, vehicle's port": stolen_route,
        "reflection: bytes beyond three times": reflection,
        "acting in the pilot's name, 15 messages": acting_in_the_pilots_name,
    }
)
#: Attacks on ports without signing, where pilot and attackers share a port; of ours by the firewall alone.
UNSIGNED: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {
        "unsigned port: acting beside the pilot": beside_the_pilot,
        "unsigned port: pilot cut off by a stranger": malformed_in_the_pilots_name,
    }
)
#: Attacks on routers that only join links, without firewall and signing: what each router is by itself.
PLAIN: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {
        "no firewall: route stolen, third endpoint": stolen_route_by_any_message,
        "no firewall: route stolen beside the vehicle": stolen_route,
        "no firewall: bytes beyond three times": reflection,
        "no firewall: 300 ports, pilots locked out": many_ports,
    }
)
#: Bytes that a router without a firewall sends to an invented address for each byte in its name.
FACTORS: Final[Mapping[str, Callable[[Range], float]]] = MappingProxyType(
    {"no firewall: reflected bytes for each byte": reflection_factor}
)


#: The figures of a flood, in milliseconds.
FLOOD: Final = (
    "flood: delay added to acknowledgements",
    "jitter of telemetry without a flood",
    "flood: jitter of telemetry",
)


def _timed(field: Range) -> tuple[float, float]:
    """Return the median delay of acknowledgements, and the standard deviation of that of telemetry."""
    delays = field.acknowledge_delays(_COMMANDS)
    return median(delays), pstdev(field.telemetry_delays(_TELEMETRY))


def _upload(attacker: Station) -> None:
    target = {"target_system": 1, "target_component": 1}
    attacker.send(
        common.MissionCount(**target, count=1),
        common.MissionItem(**target, seq=0, command=16, x=1.0, y=2.0, z=3.0),
        common.MissionClearAll(**target),
    )


def _flood(attacker: Station, packet: bytes, end: threading.Event) -> None:
    while not end.is_set():
        for _ in range(50):
            attacker.socket.sendto(packet, ("127.0.0.1", attacker.router[1]))
