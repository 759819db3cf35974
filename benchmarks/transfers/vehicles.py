"""The vehicles: programs that are started for a run, our own or those of a JSON file.

    [{"name": "PX4", "command": ["/path/to/start"], "works": ["parameters", "file"],
      "remote_file": "300k.bin", "local_file": "/path/to/300k.bin", "packed": false, "home_first": false}]

The command gets two additional arguments: the UDP port of 127.0.0.1 on which the relay listens, and the
letter of the condition, so that the vehicle can adapt its telemetry to the link.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

from .model import Work

if TYPE_CHECKING:
    from collections.abc import Iterator

#: The condition without a relay: the vehicle listens, and the client sends to it.
DIRECT = "direct"
REMOTE_FILE, LARGE_FILE = "file300k.bin", "file10m.bin"
FILE_SIZES = {REMOTE_FILE: 300_000, LARGE_FILE: 10_000_000}


def file_content(name: str) -> bytes:
    """Return the content of a file of our vehicle: equal in every process, and not compressible."""
    return Random(0).randbytes(FILE_SIZES[name])


def link_url(port: int, condition: str) -> str:
    """Return the link of a vehicle: to the relay, or without a relay the one on which it listens."""
    return f"{'udpin' if condition == DIRECT else 'udpout'}://127.0.0.1:{port}"


@dataclass(frozen=True, slots=True)
class Vehicle:
    """A vehicle program and its properties."""

    name: str
    command: tuple[str, ...]
    works: tuple[Work, ...]
    remote_file: str = ""
    local_file: str = ""
    packed: bool = False  # has @PARAM/param.pck
    home_first: bool = False  # item 0 is the home position, which the vehicle sets itself

    @contextmanager
    def running(self, port: int, condition: str) -> Iterator[None]:
        """Start the program, and kill it with all its children."""
        with subprocess.Popen(
            [*self.command, str(port), condition],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        ) as process:
            try:
                yield
            finally:
                os.killpg(process.pid, signal.SIGKILL)

    def file(self) -> bytes:
        """Return the content of its file."""
        return Path(self.local_file).read_bytes()


def ours(folder: Path, name: str = REMOTE_FILE) -> Vehicle:
    """Return Mavstack as the vehicle; one of its files is written to `folder` for comparison."""
    local_file = folder / name
    local_file.write_bytes(file_content(name))
    program = "benchmarks.transfers.our_vehicle"
    return Vehicle("mavstack", (sys.executable, "-m", program), tuple(Work), name, str(local_file))


def simulated() -> Vehicle:
    """Return a simulated PX4 with 1,500 parameters and no large file."""
    program = "benchmarks.transfers.sim_vehicle"
    works = (Work.PARAMETERS, Work.MISSION_UP, Work.MISSION_DOWN)
    return Vehicle("simulated PX4", (sys.executable, "-m", program), works)


def read(path: Path) -> list[Vehicle]:
    """Read the vehicles of a JSON file."""
    return [
        Vehicle(
            name=item["name"],
            command=tuple(item["command"]),
            works=tuple(Work(work) for work in item.get("works", list(Work))),
            remote_file=item.get("remote_file", ""),
            local_file=item.get("local_file", ""),
            packed=item.get("packed", False),
            home_first=item.get("home_first", False),
        )
        for item in json.loads(path.read_text(encoding="utf-8"))
    ]
