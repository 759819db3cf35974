"""mavlink-router, to compare with: the program in MAVLINK_ROUTERD, or an installed one."""

from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import contextmanager
from time import sleep
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

PROGRAM = "mavlink-routerd"
#: Environment variable with the path of the program.
VARIABLE = "MAVLINK_ROUTERD"
START_TIME = 0.5


def find_mavlink_router() -> str | None:
    """Return the path of the program; None if there is none."""
    return os.environ.get(VARIABLE) or shutil.which(PROGRAM)


@contextmanager
def running_mavlink_router(ports: Mapping[str, int], folder: Path) -> Iterator[None]:
    """Run mavlink-router with a listening UDP endpoint on each port; skip the test if there is none."""
    program = find_mavlink_router()
    if program is None:
        pytest.skip(f"mavlink-router is not installed, and {VARIABLE} does not name it")
    configuration = folder / "main.conf"
    endpoints = [
        f"[UdpEndpoint {name}]\nMode = Server\nAddress = 127.0.0.1\nPort = {port}\n"
        for name, port in ports.items()
    ]
    configuration.write_text("[General]\nTcpServerPort = 0\n" + "".join(endpoints))
    with subprocess.Popen([program, "-c", str(configuration)], stderr=subprocess.PIPE) as process:
        sleep(START_TIME)
        assert process.poll() is None, process.stderr and process.stderr.read()
        try:
            yield
        finally:
            process.terminate()
