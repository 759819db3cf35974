"""WebSocket clients, for the benchmark.

    python -m benchmarks.station.clients PORT COUNT [IDLE] [--path /ws] [--subprotocol NAME] [--hello TEXT]

COUNT clients read everything, IDLE further ones never read. They offer compression, as browsers do. For each
line on standard input the program prints one JSON object: the packets that each reading client got since the
last line, where a text is one packet. HELLO is the text that each client sends first.
"""

from __future__ import annotations

import argparse
import json
import select
import sys

from .websocket import BINARY, TEXT, WebSocket, handshake

RAW = "mavstack.raw.1"
MAGIC, HEADER, CHECKSUM, SIGNATURE = 0xFD, 10, 2, 13
#: The buffer of a client that does not read, in bytes.
SMALL_BUFFER = 4096


class Client(WebSocket):
    """One client, which counts packets."""

    packets = 0

    def take(self, opcode: int, data: bytes, start: int, end: int) -> None:
        """Count the packets of a message."""
        if opcode == TEXT:
            self.packets += 1
        while opcode == BINARY and start < end:
            if data[start] != MAGIC:
                raise SystemExit("a message does not begin with a packet")
            signed = data[start + 2] & 1
            start += HEADER + data[start + 1] + CHECKSUM + SIGNATURE * signed
            self.packets += 1


def _connect(options: argparse.Namespace, *, reads: bool = True) -> Client:
    request = handshake(options.port, options.path, options.subprotocol)
    client = Client(options.port, request, buffer=None if reads else SMALL_BUFFER)
    if options.hello:
        client.send(TEXT, options.hello.encode())
    client.sock.setblocking(False)
    return client


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station.clients")
    parser.add_argument("port", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("idle", type=int, nargs="?", default=0)
    parser.add_argument("--path", default="/ws")
    parser.add_argument("--subprotocol", default=RAW)
    parser.add_argument("--hello", default="")
    return parser.parse_args()


def main() -> None:
    """Read until standard input is closed."""
    options = _options()
    clients = {client.sock.fileno(): client for client in (_connect(options) for _ in range(options.count))}
    lazy = [_connect(options, reads=False) for _ in range(options.idle)]
    poll = select.epoll()
    for number in (sys.stdin.fileno(), *clients):
        poll.register(number, select.EPOLLIN)
    print("ready", flush=True)
    while True:
        for number, _ in poll.poll():
            if number != sys.stdin.fileno():
                clients[number].read()
                continue
            if not sys.stdin.readline():
                return
            print(json.dumps([client.packets for client in clients.values()]), flush=True)
            for client in (*clients.values(), *lazy):
                client.packets = 0


if __name__ == "__main__":
    main()
