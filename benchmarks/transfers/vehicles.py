"""The vehicles: programs that are started for a run, our own or those that a JSON file describes.

    [{"name": "PX4", "command": ["/path/to/start"], "works": ["parameters", "file"],
      "remote_file": "300k.bin", "local_file": "/path/to/300k.bin", "packed": false, "home_first": false}]

The command gets two more arguments: the UDP port of 127.0.0.1 that it sends to, where the relay listens, and
the letter of the condition, so that it can send what is normal over such a link.
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
from typing import TYPE_CHECKING

from .model import Work
from .our_vehicle import REMOTE_FILE, file_content

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True, slots=True)
class Vehicle:
    """A vehicle, and what is known of it beforehand."""

    name: str
    command: tuple[str, ...]
    works: tuple[Work, ...]
    remote_file: str = ""
    local_file: str = ""
    packed: bool = False  # has @PARAM/param.pck
    home_first: bool = False  # item 0 is its home, which it chooses itself

    @contextmanager
    def running(self, port: int, condition: str) -> Iterator[None]:
        """Start it, and end it with all that it started."""
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
        """What its file holds."""
        return Path(self.local_file).read_bytes()


def ours(folder: Path) -> Vehicle:
    """Mavstack itself as the vehicle; `folder` gets a copy of its file, to compare with."""
    local_file = folder / REMOTE_FILE
    local_file.write_bytes(file_content())
    program = "benchmarks.transfers.our_vehicle"
    return Vehicle("mavstack", (sys.executable, "-m", program), tuple(Work), REMOTE_FILE, str(local_file))


def simulated() -> Vehicle:
    """A simulated PX4, which has 1,500 parameters and no file worth reading."""
    program = "benchmarks.transfers.sim_vehicle"
    works = (Work.PARAMETERS, Work.MISSION_UP, Work.MISSION_DOWN)
    return Vehicle("simulated PX4", (sys.executable, "-m", program), works)


def read(path: Path) -> list[Vehicle]:
    """The vehicles that a file describes."""
    return [
        Vehicle(
            name=one["name"],
            command=tuple(one["command"]),
            works=tuple(Work(work) for work in one.get("works", list(Work))),
            remote_file=one.get("remote_file", ""),
            local_file=one.get("local_file", ""),
            packed=one.get("packed", False),
            home_first=one.get("home_first", False),
        )
        for one in json.loads(path.read_text(encoding="utf-8"))
    ]
