"""Attacks by many clients on gates and sealed links: return 1 if a client with a credential is locked out."""

from __future__ import annotations

import os
import socket
import ssl
from contextlib import ExitStack, suppress
from time import monotonic, sleep
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.security.sealed import SealConfig, Tunnel
from mavstack.wire import Encoder
from tools.attacks.gates import accepts_ticket
from tools.attacks.range import ARM
from tools.attacks.routers import KEY, STATION

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from tools.attacks.range import Range

#: Connections and ports of an attacker.
_CONNECTIONS: Final = 160
_PORTS: Final = 300
#: Attempts of a client with a credential, and seconds between them.
_ATTEMPTS: Final = 5
_PAUSE: Final = 0.5
_HALF: Final = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\n"
_OPEN_TIMEOUT: Final = 10.0


def silent_at_the_gate(field: Range) -> int:
    """Fill the WebSocket gate with silent connections and half requests."""
    address = ("127.0.0.1", field.ports.gate)
    with ExitStack() as stack:
        for number in range(_CONNECTIONS):
            connection = stack.enter_context(socket.create_connection(address, timeout=5))
            if number % 2:
                connection.sendall(_HALF)
        for _ in range(_ATTEMPTS):
            if accepts_ticket(field):
                return 0
            sleep(_PAUSE)
    return 1


def ports_at_the_sealed_link(field: Range) -> int:
    """Send the first handshake message of another key, and noise, from 300 ports."""
    address = ("127.0.0.1", field.ports.sealed)
    with ExitStack() as stack:
        for number in range(_PORTS):
            wire = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            tunnel = Tunnel(SealConfig.shared(os.urandom(32)), initiates=True)
            tunnel.handle_timeout(monotonic())
            for datagram in (*tunnel.datagrams_to_send(), os.urandom(40)):
                wire.sendto(datagram, address)
            if number % 16 == 0:
                sleep(0.001)
        return int(not _opens(address))


def _opens(address: tuple[str, int]) -> bool:
    """Return whether a tunnel with the key opens."""
    tunnel = Tunnel(SealConfig.shared(KEY.secret_bytes()), initiates=True)
    end = monotonic() + _OPEN_TIMEOUT
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.settimeout(0.2)
        while not tunnel.is_open and monotonic() < end:
            tunnel.handle_timeout(monotonic())
            for datagram in tunnel.datagrams_to_send():
                wire.sendto(datagram, address)
            try:
                tunnel.receive(wire.recv(4096), monotonic())
            except TimeoutError:
                continue
    return tunnel.is_open


def silent_at_tls(field: Range) -> int:
    """Fill a TLS endpoint with silent connections; a station that comes then commands."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    address = ("127.0.0.1", field.ports.tls)
    command = Encoder(*STATION).encode(common.CommandLong(target_system=1, target_component=1, command=ARM))
    with ExitStack() as stack:
        for _ in range(_CONNECTIONS):
            stack.enter_context(socket.create_connection(address, timeout=5))
        for _ in range(_ATTEMPTS):
            with (
                suppress(OSError),
                socket.create_connection(address, timeout=5) as wire,
                context.wrap_socket(wire) as station,
            ):
                station.sendall(command)
                if field.passed(1):
                    return 0
            sleep(_PAUSE)
    return 1


#: Attacks by many clients, by their names in the table.
LOCKOUTS: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {
        "gate: silent connections lock out": silent_at_the_gate,
        "TLS: silent connections lock out": silent_at_tls,
        "sealed link: 300 ports lock out": ports_at_the_sealed_link,
    }
)
