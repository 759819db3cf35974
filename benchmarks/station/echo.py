"""A program that sends each datagram back, for the benchmark: the delay of the machine without a station."""

from __future__ import annotations

import socket

HOST = "127.0.0.1"


def main() -> None:
    """Print the port, and answer until the program is ended."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind((HOST, 0))
        print(sock.getsockname()[1], flush=True)
        while True:
            data, peer = sock.recvfrom(4096)
            sock.sendto(data, peer)


if __name__ == "__main__":
    main()
