"""Ctrl-C during `mav ftp get` and `put`, in processes of their own, over a link that loses packets."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from mavstack.sim import BackgroundSimulator

if TYPE_CHECKING:
    from collections.abc import Callable

DATA = bytes(400_000)
#: Seconds after which a transfer has begun, also on a busy machine.
START_TIME = 60.0


def wait_until(condition: Callable[[], bool]) -> None:
    ends_at = time.monotonic() + START_TIME
    while not condition():
        assert time.monotonic() < ends_at
        time.sleep(0.02)


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="there is no such signal")
@pytest.mark.parametrize("action", ["get", "put"])
def test_ctrl_c_ends_a_transfer_on_both_ends(tmp_path, action):
    (tmp_path / "new.bin").write_bytes(DATA)
    words = {"get": ["/APM/big.bin", "got.bin"], "put": ["new.bin", "/APM/new.bin"]}[action]
    with BackgroundSimulator("copter", "ardupilot", loss=0.2) as simulator:
        server = simulator.vehicle.services.files
        store = simulator.vehicle.storage.store
        simulator.call(lambda: store.__setitem__("/APM/big.bin", DATA))  # type: ignore[index]
        command = [sys.executable, "-m", "mavstack", "ftp", action, *words, "--url", simulator.url]
        with subprocess.Popen(
            command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process:
            wait_until(lambda: len(server.sessions) == 1)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=START_TIME)
        assert (process.returncode, out, err) == (130, "", "")
        assert len(server.sessions) == 0
        names = {entry.name for entry in store.list_directory("/APM")}
    assert not {"new.bin", "new.bin.part"} & names
    assert not (tmp_path / "got.bin").exists()
