"""`mav watch` of 100 vehicles, each with 100 messages a second: the share of a core of its live display."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from statistics import median
from threading import Thread
from typing import TYPE_CHECKING, Final

from .measure import apart, pinned
from .recorder import free_port, processor_time

if TYPE_CHECKING:
    from collections.abc import Iterator

VEHICLES, RATE = 100, 100
SECONDS: Final = 8.0
_TARGET: Final = 0.3
#: Seconds until the first display is up and the vehicles are known.
_START_TIME: Final = 3.0
_FOLDER: Final = Path(__file__).parents[1]


def main(turns: int = 3) -> None:
    """Measure, and print a line."""
    shares = [_turn() for _ in range(turns)]
    reached = "ok" if median(shares) <= _TARGET else "MISSED"
    print(
        f"mav watch, {VEHICLES} vehicles at {RATE}/s: {median(shares):.2f} of a core "
        f"({min(shares):.2f}-{max(shares):.2f}; target {_TARGET} {reached})"
    )


def _turn() -> float:
    port = free_port()
    with _watch(port) as watch, apart(), _sender(port):
        time.sleep(_START_TIME)
        before, at = processor_time(watch.pid), time.monotonic()
        time.sleep(SECONDS - _START_TIME - 1.0)
        return (processor_time(watch.pid) - before) / (time.monotonic() - at)


@contextmanager
def _watch(port: int) -> Iterator[subprocess.Popen[bytes]]:
    """Run `mav watch` on a terminal, of which the output is read and dropped."""
    ours, its = os.openpty()
    command = [sys.executable, "-m", "mavstack", "watch", f"udpin://127.0.0.1:{port}"]
    with closing(os.fdopen(ours, "rb", buffering=0)) as output:
        with pinned():
            watch = subprocess.Popen(command, stdin=its, stdout=its, stderr=subprocess.DEVNULL, cwd=_FOLDER)
        os.close(its)
        reader = Thread(target=_drain, args=[output.fileno()], daemon=True)
        reader.start()
        try:
            _wait_until_bound(port)
            yield watch
        finally:
            watch.send_signal(signal.SIGTERM)
            watch.wait(10)
            reader.join(2.0)


def _wait_until_bound(port: int) -> None:
    """Wait until datagrams to a port are not refused any more."""
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as sock:
        sock.connect(("127.0.0.1", port))
        while True:
            sock.send(b"")
            time.sleep(0.2)
            with suppress(ConnectionRefusedError):
                sock.send(b"")
                return


def _drain(descriptor: int) -> None:
    try:
        while os.read(descriptor, 1 << 16):
            pass
    except OSError:  # the terminal is closed
        return


@contextmanager
def _sender(port: int) -> Iterator[None]:
    command = [sys.executable, "-m", "benchmarks.fleets.sender", *map(str, (SECONDS, VEHICLES, RATE, port))]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=_FOLDER
    ) as sender:
        assert sender.stdin is not None
        assert sender.stdout is not None
        sender.stdout.readline()
        sender.stdin.write("\n")
        sender.stdin.flush()
        yield
        sender.communicate()


if __name__ == "__main__":
    main()
