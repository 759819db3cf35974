"""A vehicle in a separate process, which sends numbered packets until it is ended.

    python -m tests.node.telemetry_sender KIND ADDRESS SYSTEM LIFE

Each packet has the life of the process, the number of its connection, and the number of the packet in this
connection. `udp` and `tcp` send to a port of this machine; `unix` listens on a path; `serial` makes a
pseudo-terminal, and a link to it at a path.
"""

from __future__ import annotations

import os
import socket
import sys
from contextlib import suppress
from pathlib import Path
from select import select
from time import sleep
from tty import setraw
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Callable

#: Seconds between two groups of packets, and the packets of a group.
INTERVAL: Final = 0.005
GROUP: Final = 5

HEARTBEAT: Final = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
HOST: Final = "127.0.0.1"


def send_over_connection(descriptor: int, encoder: Encoder, life: int, connection: int) -> None:
    """Send packets until the connection is lost.

    Raises:
        OSError: The connection is lost.
    """
    for number in range(sys.maxsize):
        message = common.DebugVect(name="n", time_usec=life, x=float(connection), y=float(number))
        messages = [HEARTBEAT, message] if number % 20 == 0 else [message]
        for each in messages:
            write_all(descriptor, encoder.encode(each))
        if number % GROUP == GROUP - 1:
            sleep(INTERVAL)


def write_all(descriptor: int, data: bytes) -> None:
    """Write data to a descriptor, which does not block; wait until it accepts all of it."""
    while data:
        try:
            data = data[os.write(descriptor, data) :]
        except BlockingIOError:
            select([], [descriptor], [])


def udp(address: str) -> int:
    """Return the descriptor of a socket that sends to a port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect((HOST, int(address)))
        return sock.detach()


def tcp(address: str) -> int:
    """Return the descriptor of a connection to a port."""
    return socket.create_connection((HOST, int(address))).detach()


def unix(address: str) -> int:
    """Return the descriptor of the next connection to a path."""
    Path(address).unlink(missing_ok=True)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(address)
        server.listen()
        return server.accept()[0].detach()


def serial(address: str) -> int:
    """Return the vehicle's end of a pseudo-terminal; a symbolic link at the path leads to the other end."""
    master, slave = os.openpty()
    setraw(slave)
    new = Path(f"{address}.new")
    new.symlink_to(os.ttyname(slave))
    new.replace(address)
    os.close(slave)
    return master


KINDS: Final[dict[str, Callable[[str], int]]] = {"udp": udp, "tcp": tcp, "unix": unix, "serial": serial}


def main(kind: str, address: str, system: str, life: str) -> None:
    """Send until the process is ended; connect again when the connection is lost."""
    encoder = Encoder(int(system), 1)
    for connection in range(sys.maxsize):
        with suppress(OSError):
            descriptor = KINDS[kind](address)
            os.set_blocking(descriptor, False)
            try:
                send_over_connection(descriptor, encoder, int(life), connection)
            finally:
                os.close(descriptor)
        sleep(INTERVAL)


if __name__ == "__main__":
    main(*sys.argv[1:])
