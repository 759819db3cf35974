"""`mav record` at 50,000 packets a second: packets lost, and the share of a core that it takes.

The worst case is measured, a datagram for each packet, and a stream over TCP.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack import open_log

from . import workload

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

RATE: Final = 50_000
#: Packets sent together; the sender sleeps until the next turn.
_BURST: Final = 100
_TARGET: Final = 0.15
#: Seconds until the recorder is up; a busy machine needs more.
_START_TIME: Final = 2.0


class Result(NamedTuple):
    """The share of a core that the recorder took, and the share of the packets that it lost."""

    share: float
    lost: float


def main(seconds: float = 5.0, turns: int = 5) -> None:
    """Measure, and print a line for each kind of link."""
    packets = workload.build(int(RATE * seconds)).packets(int(RATE * seconds))
    for scheme, send in (("udpin", _datagrams), ("tcpin", _stream)):
        results = [_turn(scheme, send, packets) for _ in range(turns)]
        shares = [result.share for result in results]
        reached = "ok" if median(shares) <= _TARGET else "MISSED"
        print(
            f"mav record {scheme}, {RATE:,} packets/s: {median(shares):.2f} of a core "
            f"({min(shares):.2f}-{max(shares):.2f}; target {_TARGET} {reached}), "
            f"lost {max(result.lost for result in results):.4%}"
        )


def _turn(
    scheme: str, send: Callable[[socket.socket, Sequence[bytes]], None], packets: Sequence[bytes]
) -> Result:
    """Record the packets once."""
    port = free_port()
    with tempfile.TemporaryDirectory(prefix="mavstack-bench-") as folder:
        path = Path(folder) / "flight.tlog"
        words = [sys.executable, "-m", "mavstack", "record", f"{scheme}://127.0.0.1:{port}", str(path)]
        recorder = subprocess.Popen(words, stderr=subprocess.DEVNULL)
        try:
            with closing(_connected(scheme, port)) as sock:
                time.sleep(_START_TIME)
                before = processor_time(recorder.pid)
                started = time.monotonic()
                send(sock, packets)
                elapsed = time.monotonic() - started
                time.sleep(0.3)
                share = (processor_time(recorder.pid) - before) / elapsed
        finally:
            recorder.send_signal(signal.SIGINT)
            recorder.wait(10)
        received = sum(open_log(path).counts.values())
    return Result(share, 1 - received / len(packets))


def _connected(scheme: str, port: int) -> socket.socket:
    """Return a socket to the recorder, as soon as it listens."""
    if scheme == "udpin":
        time.sleep(_START_TIME)
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.connect(("127.0.0.1", port))
        return sock
    deadline = time.monotonic() + 10
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)


def _paced(packets: Sequence[bytes], send: Callable[[Sequence[bytes]], None]) -> None:
    started = time.monotonic()
    for at in range(0, len(packets), _BURST):
        pause = started + at / RATE - time.monotonic()
        if pause > 0:
            time.sleep(pause)
        send(packets[at : at + _BURST])


def _datagrams(sock: socket.socket, packets: Sequence[bytes]) -> None:
    def send(burst: Sequence[bytes]) -> None:
        for packet in burst:
            sock.send(packet)

    _paced(packets, send)


def _stream(sock: socket.socket, packets: Sequence[bytes]) -> None:
    _paced(packets, lambda burst: sock.sendall(b"".join(burst)))


def processor_time(process: int) -> float:
    """Return the processor time of a process in seconds."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def free_port() -> int:
    with closing(socket.socket()) as sock:
        sock.bind(("127.0.0.1", 0))
        port: int = sock.getsockname()[1]
        return port


if __name__ == "__main__":
    main()
