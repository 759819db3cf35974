"""Measures of the processes of routers."""

from __future__ import annotations

import os
import socket
from pathlib import Path
from time import monotonic, sleep

from .peers import HOST

MAX_START_TIME = 30.0


def wait_until_bound(port: int, *, pause: float = 0.1) -> None:
    """Wait until another program has opened a UDP port."""
    end = monotonic() + MAX_START_TIME
    while monotonic() < end:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind((HOST, port))
            except OSError:
                return
        sleep(pause)


def processor_seconds(process: int) -> float:
    """Return the processor time of all threads of a process, by the nanosecond where the kernel counts so."""
    threads = list(Path(f"/proc/{process}/task").glob("*/schedstat"))
    if threads:
        return sum(int(each.read_text("ascii").split()[0]) for each in threads) / 1e9
    values = Path(f"/proc/{process}/stat").read_text("utf-8").rpartition(")")[2].split()
    return (int(values[11]) + int(values[12])) / os.sysconf("SC_CLK_TCK")
