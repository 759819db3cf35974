"""HTTP clients, for the benchmark: `python -m benchmarks.station.http_load PORT PATH CLIENTS`.

Each client keeps one connection and sends its next request when it has the answer to the last one. For each
line on standard input, which is a number of seconds, the program prints one JSON object: requests per second,
and the median and the 99th percentile of the delays in milliseconds.
"""

from __future__ import annotations

import json
import select
import socket
import sys
from statistics import quantiles
from time import perf_counter

HOST = "127.0.0.1"
LENGTH, END = b"content-length: ", b"\r\n\r\n"


class Client:
    """One connection, with the delays of its requests in seconds."""

    def __init__(self, port: int, request: bytes) -> None:
        self.sock = socket.create_connection((HOST, port))
        self.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.delays: list[float] = []
        self._request = request
        self._answer = b""
        self._sent_at = 0.0

    def send(self) -> None:
        """Send the next request."""
        self._answer, self._sent_at = b"", perf_counter()
        self.sock.sendall(self._request)

    def read(self) -> bool:
        """Read a part of the answer; returns whether it is complete."""
        data = self.sock.recv(1 << 16)
        self._answer += data
        head, end, body = self._answer.partition(END)
        if not data or not head.startswith(b"HTTP/1.1 200"):
            raise SystemExit(f"the server answered {head[:200]!r}")
        if not end or len(body) < int(head.lower().partition(LENGTH)[2].split(b"\r\n", 1)[0]):
            return False
        self.delays.append(perf_counter() - self._sent_at)
        return True


def measure(clients: dict[int, Client], poll: select.epoll, seconds: float) -> dict[str, float]:
    """Let all clients send requests, and return the figures."""
    for client in clients.values():
        client.delays.clear()
        client.send()
    waiting, started = set(clients), perf_counter()
    end = started + seconds
    while waiting:
        for number, _ in poll.poll():
            if not clients[number].read():
                continue
            if perf_counter() < end:
                clients[number].send()
            else:
                waiting.discard(number)
    delays = [each for client in clients.values() for each in client.delays]
    cut = quantiles(delays, n=100)
    rate = len(delays) / (perf_counter() - started)
    return {"rate": rate, "median": cut[49] * 1e3, "p99": cut[98] * 1e3, "requests": len(delays)}


def main() -> None:
    """Measure until standard input is closed."""
    port, path, count = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    request = f"GET {path} HTTP/1.1\r\nHost: {HOST}:{port}\r\n\r\n".encode()
    clients = {client.sock.fileno(): client for client in (Client(port, request) for _ in range(count))}
    poll = select.epoll()
    for number in clients:
        poll.register(number, select.EPOLLIN)
    for line in sys.stdin:
        print(json.dumps(measure(clients, poll, float(line))), flush=True)


if __name__ == "__main__":
    main()
