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
from typing import TYPE_CHECKING

from .model import Work
from .our_vehicle import REMOTE_FILE, file_content

if TYPE_CHECKING:
    from collections.abc import Iterator


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


def ours(folder: Path) -> Vehicle:
    """Return Mavstack as the vehicle; its file is written to `folder` for comparison."""
    local_file = folder / REMOTE_FILE
    local_file.write_bytes(file_content())
    program = "benchmarks.transfers.our_vehicle"
    return Vehicle("mavstack", (sys.executable, "-m", program), tuple(Work), REMOTE_FILE, str(local_file))


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
