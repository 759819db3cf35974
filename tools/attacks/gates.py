"""Attacks on gates that the other routers do not have: tickets, roles, sealed links.

Each returns the number of connections or packets that should not have passed.
"""

from __future__ import annotations

import os
import socket
from contextlib import ExitStack, contextmanager, suppress
from time import monotonic, time
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.security.sealed import SealConfig, Tunnel
from mavstack.security.tickets import MAVLINK_SCOPE, MAX_LIFETIME, SUBPROTOCOL, make_ticket
from mavstack.wire import Encoder
from tools.attacks.range import ARM
from tools.attacks.routers import KEY, STATION, TICKET_KEY
from tools.attacks.websocket import frame, requested

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from mavstack.dialects import Message
    from tools.attacks.range import Range

#: Commands in the test of a sealed link.
_COMMANDS: Final = 10
#: Requests of each observer, silent connections, and commands of a station behind them.
_REQUESTS: Final = 1000
_SILENT: Final = 80
_ATTEMPTS: Final = 5
_REBOOT: Final = common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN
_VEHICLE: Final = {"target_system": 1, "target_component": 1}


def tickets(field: Range) -> int:
    """Connect without a ticket, and with forged, altered, expired, foreign and used ones."""
    now = int(time())
    valid = _ticket()
    _require(_accepts(field, valid), "a valid ticket opens the gate")
    altered = valid.replace(f"|{valid.split('|')[3]}|", f"|{now + MAX_LIFETIME}|")
    bad = [
        None,
        "",
        valid,
        altered,
        valid[:-1] + ("0" if valid[-1] != "0" else "1"),
        make_ticket("another key", now=now, nonce=os.urandom(16)),
        make_ticket(TICKET_KEY, now=now - 60, nonce=os.urandom(16)),
        make_ticket(TICKET_KEY, now=now + 60, nonce=os.urandom(16)),
        _ticket("gs.video_ws"),
        _ticket().replace("v2|", "v1|"),
    ]
    return sum(_accepts(field, each) for each in bad)


def roles(field: Range) -> int:
    """Command as an observer; change parameters, reboot and reach files as an operator."""
    with _connected(field, "observe") as observer:
        observer(
            common.CommandLong(**_VEHICLE, command=ARM, param1=1),
            common.CommandInt(**_VEHICLE, command=ARM, param1=1),
            common.SetMode(target_system=1, custom_mode=4),
            common.MissionCount(**_VEHICLE, count=1),
            common.ManualControl(target=1, z=500),
        )
        passed = field.passed()
    with _connected(field, "operate") as operator:
        operator(common.CommandLong(**_VEHICLE, command=ARM, param1=1))
        _require(field.passed(1) == 1, "an operator arms the vehicle")
        operator(
            common.ParamSet(**_VEHICLE, param_id="FENCE_ENABLE", param_value=0.0),
            common.CommandLong(**_VEHICLE, command=_REBOOT, param1=1),
            common.MissionItemInt(**_VEHICLE, command=_REBOOT, param1=1),
            common.FileTransferProtocol(**_VEHICLE, payload=bytes(251)),
        )
        return passed + field.passed()


def sealed_link(field: Range) -> int:
    """Send frames altered, cut, repeated and in another order; plain packets; old handshakes."""
    address = ("127.0.0.1", field.ports.sealed)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        tunnel = Tunnel(SealConfig.shared(KEY.secret_bytes()), initiates=True)
        handshake = _open(tunnel, wire, address)
        encoder = Encoder(*STATION)
        plain = [
            encoder.encode(common.CommandLong(**_VEHICLE, command=ARM, param1=float(number)))
            for number in range(_COMMANDS)
        ]
        frames = [tunnel.seal(packet, monotonic()) for packet in plain]
        for frame in reversed(frames):
            for altered in _altered(frame):
                wire.sendto(altered, address)
            for _ in range(2):  # the second one is a replay
                wire.sendto(frame, address)
        for datagram in (*plain, *handshake, *frames):
            wire.sendto(datagram, address)
        passed = field.passed(_COMMANDS)
    _require(passed >= _COMMANDS, "a sealed link delivers its packets in any order")
    return passed - _COMMANDS


def observers(field: Range) -> int:
    """Ask for all parameters a thousand times as each of two observers; one request may pass."""
    request = common.ParamRequestList(**_VEHICLE)
    with _connected(field, "observe") as first, _connected(field, "observe") as second:
        for observer in (first, second):
            observer(*[request] * _REQUESTS)
        passed = sum(packet.name == "PARAM_REQUEST_LIST" for packet in field.vehicle.receive())
    _require(passed >= 1, "the request of an observer reaches the vehicle")
    return passed - 1


def silent_connections(field: Range) -> int:
    """Fill a TCP endpoint with silent connections; return 1 if a station that comes then is locked out."""
    address = ("127.0.0.1", field.ports.tcp)
    with ExitStack() as stack:
        for _ in range(_SILENT):
            stack.enter_context(socket.create_connection(address, timeout=5))
        encoder = Encoder(*STATION)
        for _ in range(_ATTEMPTS):  # stations connect again; a full endpoint takes some clients per second
            with suppress(OSError), socket.create_connection(address, timeout=5) as station:
                station.sendall(encoder.encode(common.CommandLong(**_VEHICLE, command=ARM, param1=1)))
                if field.passed():
                    return 0
    return 1


#: Attacks on gates, by their names in the table.
GATES: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {
        "tickets: forged, expired, foreign, used": tickets,
        "role escalation": roles,
        "requests of observers beyond the first": observers,
        "silent connections: stations locked out": silent_connections,
        "sealed link: altered, replayed, reordered": sealed_link,
    }
)


def _ticket(scope: str = MAVLINK_SCOPE) -> str:
    return make_ticket(TICKET_KEY, now=int(time()), nonce=os.urandom(16), scope=scope)


def accepts_ticket(field: Range) -> bool:
    """Return whether the gate takes a client with a valid ticket."""
    try:
        return _accepts(field, _ticket())
    except OSError:
        return False


def _accepts(field: Range, ticket: str | None) -> bool:
    protocols = () if ticket is None else (SUBPROTOCOL, ticket)
    with requested(field.ports.gate, *protocols) as (_, accepted):
        return accepted


@contextmanager
def _connected(field: Range, role: str) -> Iterator[Callable[..., None]]:
    """Connect with a ticket of a role; yield a function that sends messages."""
    encoder = Encoder(*STATION)
    ticket = _ticket(f"{MAVLINK_SCOPE}.{role}")
    with requested(field.ports.gate, SUBPROTOCOL, ticket) as (connection, accepted):
        _require(accepted, f"a ticket to {role} opens the gate")

        def send(*messages: Message) -> None:
            for message in messages:
                connection.sendall(frame(encoder.encode(message, time())))

        yield send


def _open(tunnel: Tunnel, wire: socket.socket, address: tuple[str, int]) -> list[bytes]:
    """Open a tunnel, and return its handshake messages."""
    wire.settimeout(0.2)
    sent: list[bytes] = []
    end = monotonic() + 10
    while not tunnel.is_open:
        _require(monotonic() < end, "a sealed link opens")
        tunnel.handle_timeout(monotonic())
        sent += _flush(tunnel, wire, address)
        try:
            tunnel.receive(wire.recv(4096), monotonic())
        except TimeoutError:
            continue
    return sent + _flush(tunnel, wire, address)


def _flush(tunnel: Tunnel, wire: socket.socket, address: tuple[str, int]) -> list[bytes]:
    datagrams = tunnel.datagrams_to_send()
    for datagram in datagrams:
        wire.sendto(datagram, address)
    return datagrams


def _altered(frame: bytes) -> list[bytes]:
    """Return copies of a frame with one byte changed: in its header, its content, its tag; and cut copies."""
    copies = []
    for place in (0, 3, 10, len(frame) - 20, len(frame) - 1):
        copy = bytearray(frame)
        copy[place] ^= 1
        copies.append(bytes(copy))
    return [*copies, frame[:-1], frame[:8]]


def _require(holds: bool, expected: str) -> None:
    if not holds:
        raise SystemExit(f"mavstack: not true: {expected}")
