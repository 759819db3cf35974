"""mavlink-router, to compare with: an installed one, or one built from the source in MAVLINK_ROUTER."""

from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

PROGRAM = "mavlink-routerd"
#: Folder of its source, with its submodule; or the program.
VARIABLE = "MAVLINK_ROUTER"
START_TIME = 0.5


@cache
def find_mavlink_router() -> Path | None:
    """Return the program, which is built first if the variable names its source; None: there is none."""
    given = os.environ.get(VARIABLE) or shutil.which(PROGRAM)
    if not given:
        return None
    path = Path(given)
    return _build(path) if path.is_dir() else path


def _build(source: Path) -> Path | None:
    if not (meson := shutil.which("meson")):
        return None
    folder = source / "build"
    if not (folder / "build.ninja").exists():
        units = f"-Dsystemdsystemunitdir={folder}"
        subprocess.run(
            [meson, "setup", "--buildtype=release", units, str(folder), str(source)], check=True, timeout=300
        )
    subprocess.run(["ninja", "-C", str(folder), "src/" + PROGRAM], check=True, timeout=900)
    return folder / "src" / PROGRAM


@contextmanager
def running_mavlink_router(ports: Mapping[str, int], folder: Path) -> Iterator[None]:
    """Run mavlink-router with a listening UDP endpoint on each port; skip the test if there is none."""
    program = find_mavlink_router()
    if program is None:
        pytest.skip(f"mavlink-router is not installed, and {VARIABLE} does not name its source")
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
