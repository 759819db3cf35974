"""WebSocket clients, for the benchmark: `python -m benchmarks.station.clients PORT COUNT [IDLE]`.

COUNT clients read everything, IDLE further ones never read. They offer compression, as browsers do. For each
line on standard input the program prints one JSON object: the packets that each reading client got since the
last line.
"""

from __future__ import annotations

import json
import select
import socket
import sys

HOST = "127.0.0.1"
REQUEST = (
    "GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Protocol: mavstack.raw.1\r\n"
    "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n\r\n"
)
#: The shortest lengths of a message with a longer header.
LENGTH_16, LENGTH_64 = 126, 127
OPCODE, BINARY = 0x0F, 2
MAGIC, HEADER, CHECKSUM, SIGNATURE = 0xFD, 10, 2, 13
#: The buffer of a client that does not read, in bytes.
SMALL_BUFFER = 4096


class Client:
    """One client, which counts packets in unmasked messages."""

    def __init__(self, port: int, *, reads: bool = True) -> None:
        self.packets = 0
        self.sock = socket.socket()
        if not reads:
            self.sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL_BUFFER)
        self.sock.connect((HOST, port))
        self.sock.sendall(REQUEST.format(port=port).encode())
        answer = bytearray()
        while not answer.endswith(b"\r\n\r\n"):
            answer += self.sock.recv(1)
        if b" 101 " not in answer:
            raise SystemExit(f"the handshake failed: {answer!r}")
        if b"permessage-deflate" in answer:
            raise SystemExit("the server compresses messages")
        self._rest = b""
        self.sock.setblocking(False)

    def read(self) -> None:
        """Count the packets that have arrived."""
        data, position = self._rest + self.sock.recv(1 << 18), 0
        while position + 2 <= len(data):
            length, start = data[position + 1], position + 2
            if length >= LENGTH_16:
                size = 2 if length == LENGTH_16 else 8
                length, start = int.from_bytes(data[start : start + size]), start + size
            if len(data) < start + length or start > len(data):
                break
            if data[position] & OPCODE == BINARY:
                self._count(data, start, start + length)
            position = start + length
        self._rest = data[position:]

    def _count(self, data: bytes, position: int, end: int) -> None:
        while position < end:
            if data[position] != MAGIC:
                raise SystemExit("a message does not begin with a packet")
            signed = data[position + 2] & 1
            position += HEADER + data[position + 1] + CHECKSUM + SIGNATURE * signed
            self.packets += 1


def main() -> None:
    """Read until standard input is closed."""
    port, count, idle = (*map(int, sys.argv[1:]), 0)[:3]
    clients = {client.sock.fileno(): client for client in (Client(port) for _ in range(count))}
    lazy = [Client(port, reads=False) for _ in range(idle)]
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
