"""A program that behaves as ArduPilot's SITL does: it waits for a client, then asks for steps."""

from __future__ import annotations

import socket
import struct
import sys

from mavstack.dialects import common
from mavstack.wire import encode


def main() -> None:
    """Run until it is ended."""
    words = sys.argv[1:]
    instance = int(words[words.index("-I") + 1])
    target = 9002 + 10 * instance
    if "--sim-port-out" in words:
        target = int(words[words.index("--sim-port-out") + 1])
    print("parameters:", open("defaults.parm").read().split(), flush=True)  # noqa: SIM115, PTH123
    with socket.create_server(("127.0.0.1", 5760 + 10 * instance)) as server:
        print("waiting for connection", flush=True)
        client, _ = server.accept()
    world = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for number in range(10**9):
        world.sendto(struct.pack("<HHI16H", 18458, 400, number, *[1600] * 16), ("127.0.0.1", target))
        world.recv(4096)
        if number % 100 == 0:
            heartbeat = common.Heartbeat(type=2, autopilot=3, mavlink_version=3)
            client.sendall(encode(heartbeat, system=1, component=1))


if __name__ == "__main__":
    main()
