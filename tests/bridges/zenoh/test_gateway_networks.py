"""Two networks with a router each, joined by a link that loses packets, is cut, and heals."""

from __future__ import annotations

import fcntl
import json
import os
import select
import shutil
import struct
import subprocess
import sys
import threading
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.nightly, pytest.mark.timeout(600)]
ROOT = Path(__file__).parents[3]
NEAR, FAR = f"mavstack-n{os.getpid()}", f"mavstack-f{os.getpid()}"
#: Vehicles of each network; the environment may set others.
COUNT = int(os.environ.get("MAVSTACK_FLEET", "100"))
LOSS = 0.05
TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 2, 0x1000


def run(*words: str) -> None:
    subprocess.run(words, check=True, capture_output=True)


class Cable:
    """An Ethernet cable between two network namespaces, which loses frames and can be cut without a trace."""

    def __init__(self, stack: ExitStack) -> None:
        #: The probability that a frame is lost.
        self.loss = 0.0
        self._rng = Random(1)
        self._ends = [os.open("/dev/net/tun", os.O_RDWR) for _ in range(2)]
        for end, network, address in zip(
            self._ends, (NEAR, FAR), ("10.77.0.1/24", "10.77.0.2/24"), strict=True
        ):
            stack.callback(os.close, end)
            device = f"mav{end}-{os.getpid()}"[:15]
            fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH22x", device.encode(), IFF_TAP | IFF_NO_PI))
            run("ip", "link", "set", device, "netns", network)
            within(network, "ip", "addr", "add", address, "dev", device)
            for each in (device, "lo"):
                within(network, "ip", "link", "set", each, "up")
        self._closed = threading.Event()
        thread = threading.Thread(target=self._carry, daemon=True)
        thread.start()
        stack.callback(thread.join, 2)
        stack.callback(self._closed.set)

    def _carry(self) -> None:
        first, second = self._ends
        while not self._closed.is_set():
            for end in select.select(self._ends, [], [], 0.2)[0]:
                frame = os.read(end, 65536)
                if self._rng.random() >= self.loss:
                    os.write(second if end == first else first, frame)


@pytest.fixture(name="cable")
def _cable() -> Iterator[Cable]:
    pytest.importorskip("zenoh")
    usable = sys.platform == "linux" and not os.geteuid() and os.access("/dev/net/tun", os.W_OK)
    if not usable or shutil.which("ip") is None:
        pytest.skip("needs Linux, root, /dev/net/tun and the program ip")
    with ExitStack() as stack:
        for name in (NEAR, FAR):
            run("ip", "netns", "add", name)
            stack.callback(subprocess.run, ["ip", "netns", "del", name], check=False)
        yield Cable(stack)


def within(network: str, *words: str) -> None:
    run("ip", "netns", "exec", network, *words)


class Program:
    """A program in a network: lines in, lines of JSON out."""

    def __init__(self, process: Any) -> None:
        self.process = process

    def ask(self, line: str) -> Any:
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.answer()

    def answer(self) -> Any:
        return json.loads(self.process.stdout.readline())


@contextmanager
def program(network: str, module: str, *words: str) -> Iterator[Program]:
    command = ["ip", "netns", "exec", network, sys.executable, "-m", f"tests.bridges.zenoh.programs.{module}"]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    environment = os.environ | {"PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"}
    with subprocess.Popen([*command, *words], cwd=ROOT, env=environment, **pipes) as process:
        try:
            yield Program(process)
        finally:
            process.kill()


def test_cut_and_heal(cable: Cable) -> None:
    vehicles = str(COUNT)
    with (
        program(NEAR, "network_side", "near", "1", vehicles) as near,
        program(FAR, "network_side", "far", str(1 + COUNT), vehicles, "tcp/10.77.0.1:7447") as far,
    ):
        for each in (near, far):
            assert each.process.stdout.readline() == "ready\n"
        with program(NEAR, "network_station") as station:
            figures = scenario(station, near, far, cable)
    print(json.dumps(figures))
    assert figures["cut seen after"] < 20  # of a busy machine; four on a quiet one
    assert figures["healed after"] < 40


def scenario(station: Program, near: Program, far: Program, cable: Cable) -> dict[str, float]:
    """Cut and heal the link; return the seconds until the station sees it."""
    assert station.answer() == "ready"
    figures = {"all seen after": station.ask(f"tokens {2 * COUNT}")}
    cable.loss = LOSS
    names = [f"{side}{number}" for side in ("near", "far") for number in range(COUNT)]
    figures["packets of all after"] = station.ask("frames " + " ".join(names))
    first, second = names[COUNT : COUNT + COUNT // 2], names[COUNT + COUNT // 2 :]
    answered = station.ask("arm " + " ".join(first))
    assert {name: ok for name, (_, ok) in answered.items()} == dict.fromkeys(first, True)
    start = time.monotonic()
    cable.loss = 1.0
    station.ask(f"tokens {COUNT}")
    figures["cut seen after"] = time.monotonic() - start
    station.process.stdin.write("arm " + " ".join(second) + "\n")  # while the link is cut
    station.process.stdin.flush()
    time.sleep(2)
    start = time.monotonic()
    cable.loss = LOSS
    answered = station.answer()
    figures["commands answered after"] = time.monotonic() - start
    assert {name: ok for name, (_, ok) in answered.items()} == dict.fromkeys(second, True)
    station.ask(f"tokens {2 * COUNT}")
    figures["healed after"] = time.monotonic() - start
    figures["packets again after"] = time.monotonic() - start + station.ask("frames " + " ".join(names))
    sent = far.ask("end")
    assert set(sent.values()) == {1}  # each vehicle was armed once
    assert len(sent) == COUNT
    assert near.ask("end") == {}
    return figures
