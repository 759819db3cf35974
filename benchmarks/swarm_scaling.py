"""Processor time and bytes per vehicle of a program that flies a swarm: `python -m benchmarks.swarm_scaling`.

Simulated copters and the program run in one process in virtual time. The time of the simulator is measured
apart and subtracted, so that the rest is the program's: positions received ten times a second from each
vehicle, the controller with guard and avoidance, setpoints sent ten times a second to each. A network has 250
system ids at most, so 500 vehicles are two swarms. `--json FILE` writes the figures that
`docs/_tools/swarm_pictures.py` draws.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import logging
import math
import time
from contextlib import AsyncExitStack
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.geodesy import LocalFrame
from mavstack.links import MemoryNetwork
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import run_until
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from mavstack.vehicle.swarm.launch import take_off

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.links.memory import MemoryLink
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.vehicle.swarm import Swarm

COUNTS: Final = (10, 25, 50, 100, 250, 500)
#: Most vehicles of a network.
MAX_SWARM: Final = 250
#: Simulated seconds of the measurement, and of the flight before it.
_SECONDS, _LEAD = 10.0, 3.0
#: Seconds from boot until a vehicle can be armed.
_SETTLING: Final = 15.0
_SPACING: Final = 10.0
#: ArduPilot's streams over a slow radio, in hertz.
_STREAMS: Final = {
    "RAW_SENS": 0,
    "RC_CHAN": 0,
    "RAW_CTRL": 0,
    "EXTRA1": 0,
    "EXTRA2": 0,
    "EXTRA3": 0,
    "EXT_STAT": 1,
}


@dataclass(frozen=True, slots=True)
class Figures:
    """The figures of one number of vehicles.

    Attributes:
        vehicles: The number of vehicles.
        cpu_ms: Milliseconds of processor time for each vehicle and second.
        controller_ms: The controller's part of it.
        sent: Bytes to each vehicle in a second.
        received: Bytes from each vehicle in a second.
    """

    vehicles: int
    cpu_ms: float
    controller_ms: float
    sent: float
    received: float


class Meter:
    """Processor time within functions, the outermost call counts."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0

    def of(self, work: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function whose time is counted."""

        def measured(*arguments: Any) -> Any:  # noqa: ANN401 (those of the function)
            begin, self._depth = time.process_time(), self._depth + 1
            try:
                return work(*arguments)
            finally:
                self._depth -= 1
                if not self._depth:
                    self.seconds += time.process_time() - begin

        return measured

    def together(self, work: Callable[..., object]) -> Callable[..., None]:
        """Return a function whose calls are made later, all at once.

        Reading the processor time takes longer than the work of some calls, and would count as their
        caller's.
        """
        waiting: list[tuple[Any, ...]] = []

        def call_all() -> None:
            for arguments in waiting:
                work(*arguments)
            waiting.clear()

        measured = self.of(call_all)

        def later(*arguments: Any) -> None:  # noqa: ANN401 (those of the function)
            if not waiting:
                asyncio.get_running_loop().call_soon(measured)
            waiting.append(arguments)

        return later


class Totals:
    """Processor time of simulator and controller, and bytes on all networks."""

    def __init__(self) -> None:
        self.simulator = Meter()
        self.controller = Meter()
        self.sent = self.received = 0

    def watch(self, runner: Runner, link: MemoryLink) -> None:
        """Measure a simulation, and what its link does with the packets that it receives."""
        inbox: Any = link.inbox
        inbox.put = self.simulator.together(inbox.put)
        simulation: Any = runner.simulation
        watched: Any = runner
        for vehicle in simulation.vehicles:
            self._watch_bytes(vehicle)
        simulation.advance = self.simulator.of(simulation.advance)
        watched.flush = self.simulator.of(watched.flush)
        for name in ("_take", "_flush"):
            setattr(watched, name, self.simulator.of(getattr(watched, name)))

    def watch_swarm(self, swarm: Swarm) -> None:
        """Measure the controller of a swarm."""
        controller = getattr(swarm, "_running")  # noqa: B009 (not public)
        setattr(controller, "_step", self.controller.of(getattr(controller, "_step")))  # noqa: B009, B010

    def now(self) -> tuple[float, float, float, int, int]:
        """Return all totals, that of the process first."""
        times = time.process_time(), self.simulator.seconds, self.controller.seconds
        return *times, self.sent, self.received

    def _watch_bytes(self, vehicle: Any) -> None:  # noqa: ANN401 (its methods are replaced)
        take, give = vehicle.receive, vehicle.data_to_send

        def receive(port: object, data: bytes) -> object:
            self.sent += len(data)
            return take(port, data)

        def data_to_send() -> Sequence[tuple[object, bytes]]:
            found: Sequence[tuple[object, bytes]] = give()
            self.received += sum(len(data) for _, data in found)
            return found

        vehicle.receive, vehicle.data_to_send = receive, data_to_send


def measure(count: int) -> Figures:
    """Fly a number of vehicles, and return their figures."""
    return run_virtually(_fly(count))


async def _fly(count: int) -> Figures:
    totals = Totals()
    async with AsyncExitStack() as stack:
        swarms = [await _start(stack, totals, size) for size in sizes(count)]
        flights = [asyncio.create_task(swarm.move(north=200.0)) for swarm in swarms]
        await asyncio.sleep(_LEAD)
        before = totals.now()
        await asyncio.sleep(_SECONDS)
        process, simulator, controller, sent, received = (
            after - early for after, early in zip(totals.now(), before, strict=True)
        )
        for flight in flights:
            flight.cancel()
        await asyncio.gather(*flights, return_exceptions=True)
    each = count * _SECONDS
    return Figures(
        count, 1e3 * (process - simulator) / each, 1e3 * controller / each, sent / each, received / each
    )


def sizes(count: int) -> list[int]:
    """Return the numbers of vehicles of equally large swarms, one for each network."""
    parts = math.ceil(count / MAX_SWARM)
    return [count // parts + (index < count % parts) for index in range(parts)]


async def _start(stack: AsyncExitStack, totals: Totals, count: int) -> Swarm:
    """Let vehicles take off, and return their swarm."""
    network, simulation = MemoryNetwork(), _simulation(count)
    runner = await stack.enter_async_context(Runner(simulation))
    link = network.link()
    totals.watch(runner, link)
    await runner.connect(link, simulation.vehicles)
    runner.start()
    connection = await stack.enter_async_context(connect(network.link()))
    group = await connection.wait_for_vehicles(count, timeout=60.0)
    (await take_off(group, 10.0)).check()
    swarm = await stack.enter_async_context(connection.swarm())
    totals.watch_swarm(swarm)
    return swarm


def _simulation(count: int) -> Simulation:
    """Return copters on a grid that can be armed, with little telemetry but positions."""
    simulation = Simulation(seed=1)
    frame = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
    side = math.ceil(math.sqrt(count))
    for index in range(count):
        row, column = divmod(index, side)
        latitude, longitude, _ = frame.to_global(_SPACING * row, _SPACING * column, 0.0)
        home = Home(latitude, longitude, DEFAULT_HOME.altitude)
        vehicle = simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT, home=home)
        for stream, rate in _STREAMS.items():
            vehicle.parameters.set(f"SR0_{stream}", rate)
    for vehicle in simulation.vehicles:
        run_until(simulation, partial(_is_booted, vehicle))
    simulation.advance(simulation.now + _SETTLING)
    for vehicle in simulation.vehicles:
        vehicle.data_to_send()
    return simulation


def _is_booted(vehicle: SimulatedVehicle) -> bool:
    return vehicle.autopilot.booted


def figures(counts: Sequence[int] = COUNTS) -> Iterator[Figures]:
    """Measure each number of vehicles."""
    yield from map(measure, counts)


def main() -> None:
    """Measure, print a line for each number of vehicles, and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", nargs="*", type=int, help="numbers of vehicles")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the file to write")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    found = []
    for each in figures(arguments.counts or COUNTS):
        found.append(asdict(each))
        print(
            f"{each.vehicles:4} vehicles: {each.cpu_ms:.2f} ms of processor time per vehicle and second "
            f"({each.controller_ms:.2f} ms controller), {each.sent:.0f} bytes/s to it, "
            f"{each.received:.0f} bytes/s from it",
            flush=True,
        )
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(found, indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()
