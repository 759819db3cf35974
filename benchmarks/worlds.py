"""`python -m benchmarks.worlds [--seconds N]`: the cost of simulated worlds for real firmware.

    step        our part of a step: sensors, packets, the quadrotor; beside a step of rotorpy's quadrotor
    lockstep    steps in a second over TCP, with a stand-in for PX4 in another process, beside real time (250)
    questions   JSON round trips in a second over UDP, with a stand-in for ArduPilot in another process
    ten         the steps of ten lockstep worlds at once, all in one process

Ratios belong to one run: the machine decides the absolute figures.
"""

from __future__ import annotations

import argparse
import asyncio
import socket
import struct
import subprocess
import sys
import time

from mavstack.dialects import Dialect, common
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators import ArduPilotSimulator, Px4Simulator, Sensors, load_physics
from mavstack.simulators.ardupilot import JsonInterface
from mavstack.simulators.px4 import STEP, Px4Interface
from mavstack.wire import Parser, encode
from tools.child_processes import end_children_with_this_process

REAL_TIME = 1e6 / STEP
STEPS = 20_000
_ANSWER = encode(common.HilActuatorControls(controls=[0.55] * 16, mode=129, flags=1), system=1, component=1)


def main() -> None:
    """Print the table, or run as a stand-in."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--stand-in", choices=("px4", "ardupilot"), help=argparse.SUPPRESS)
    parser.add_argument("--port", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.stand_in:
        (_px4 if options.stand_in == "px4" else _ardupilot)(options.port)
        return
    end_children_with_this_process()
    px4, json = _px4_step(), _json_step()
    peer = _rotorpy_step()
    print(f"step, PX4        {px4:8.1f} us", f"{peer / px4:6.1f} x a step of rotorpy" if peer else "")
    print(f"step, JSON       {json:8.1f} us", f"{peer / json:6.1f} x a step of rotorpy" if peer else "")
    rate = asyncio.run(_lockstep(1, options.seconds))
    print(f"lockstep         {rate:8.0f} /s {rate / REAL_TIME:6.1f} x real time")
    rate = asyncio.run(_questions(options.seconds))
    print(f"questions        {rate:8.0f} /s")
    rate = asyncio.run(_lockstep(10, options.seconds))
    print(f"ten worlds       {rate:8.0f} /s {rate / REAL_TIME / 10:6.1f} x real time each")


def _px4_step() -> float:
    """Return the microseconds of a step with PX4's packets."""
    physics, outputs = load_physics("copter")
    interface = Px4Interface(Dialect.load("common"), Sensors(DEFAULT_HOME))
    interface.connected()
    state = physics.reset(DEFAULT_HOME, 0.0)
    begun = time.process_time()
    for _ in range(STEPS):
        interface.step(state)
        interface.feed(_ANSWER)
        state = physics.step(outputs.of_controls(interface.controls), 0.004).checked()
    return (time.process_time() - begun) / STEPS * 1e6


def _json_step() -> float:
    """Return the microseconds of an answer of JSON."""
    physics, outputs = load_physics("copter")
    interface = JsonInterface(physics, outputs, DEFAULT_HOME, Sensors(DEFAULT_HOME))
    begun = time.process_time()
    for number in range(STEPS):
        interface.answer(struct.pack("<HHI16H", 18458, 400, number, *[1550] * 16))
    return (time.process_time() - begun) / STEPS * 1e6


def _rotorpy_step() -> float | None:
    """Return the microseconds of a step of rotorpy's quadrotor; None without rotorpy."""
    try:
        physics, _ = load_physics("rotorpy:hummingbird")
    except ImportError:
        return None
    physics.reset(DEFAULT_HOME, 0.0)
    begun = time.process_time()
    for _ in range(STEPS // 40):
        physics.step([0.5] * 4, 0.004)
    return (time.process_time() - begun) / (STEPS // 40) * 1e6


async def _lockstep(count: int, seconds: float) -> float:
    """Return the steps in a second of some worlds together."""
    worlds = [Px4Simulator(listen="tcpin://127.0.0.1:0", speed=0.0, seed=number) for number in range(count)]
    for world in worlds:
        await world.__aenter__()
    peers = [_start("px4", world.port) for world in worlds]
    runs = [asyncio.ensure_future(world.run()) for world in worlds]
    try:
        while min(world.interface.steps for world in worlds) < 100:  # noqa: ASYNC110 (no event for it)
            await asyncio.sleep(0.05)
        before, begun = sum(world.interface.steps for world in worlds), time.monotonic()
        await asyncio.sleep(seconds)
        rate = (sum(world.interface.steps for world in worlds) - before) / (time.monotonic() - begun)
        extra = sum(world.interface.extra_answers for world in worlds)
        if extra:
            print(f"{extra} answers were not asked for")
        return rate
    finally:
        for peer in peers:
            peer.kill()
        await asyncio.gather(*runs, return_exceptions=True)
        for world in worlds:
            await world.__aexit__(None, None, None)


async def _questions(seconds: float) -> float:
    """Return the round trips in a second of ArduPilot's interface."""
    async with ArduPilotSimulator(listen="udpin://127.0.0.1:0") as world:
        peer = _start("ardupilot", world.port)
        run = asyncio.ensure_future(world.run())
        try:
            while world.interface.steps < 100:  # noqa: ASYNC110 (no event for it)
                await asyncio.sleep(0.05)
            before, begun = world.interface.steps, time.monotonic()
            await asyncio.sleep(seconds)
            return (world.interface.steps - before) / (time.monotonic() - begun)
        finally:
            peer.kill()
            run.cancel()
            await asyncio.gather(run, return_exceptions=True)


def _start(name: str, port: int) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "benchmarks.worlds", "--stand-in", name, "--port", str(port)]
    return subprocess.Popen(words)


def _px4(port: int) -> None:
    """Answer each HIL_SENSOR as PX4 does."""
    parser = Parser(Dialect.load("common"))
    with socket.create_connection(("127.0.0.1", port)) as link:
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        while data := link.recv(65536):
            for packet in parser.feed(data):
                if packet.message_id == 107:  # HIL_SENSOR
                    link.sendall(_ANSWER)


def _ardupilot(port: int) -> None:
    """Ask for steps as ArduPilot does."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.connect(("127.0.0.1", port))
        link.settimeout(1.0)
        for number in range(10**9):
            link.send(struct.pack("<HHI16H", 18458, 400, number, *[1550] * 16))
            link.recv(4096)


if __name__ == "__main__":
    main()
