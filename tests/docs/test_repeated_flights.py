"""The programs of README and of the first tutorial fly twice in a row, with each firmware, in virtual time.

ArduPilot stays in RTL after the first flight, where it does not arm.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

import mavstack
from mavstack.links import MemoryNetwork
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.docs.blocks import DOCS, ROOT
from tests.sim.running import reduce_telemetry, running

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

PAGES = {"README": ROOT / "README.md", "tutorial": DOCS / "tutorials" / "first-flight.md"}


def main_of(page: str) -> Callable[[], Awaitable[None]]:
    """Return the `main` of the page's program that flies a square."""
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGES[page].read_text("utf-8"), re.MULTILINE | re.DOTALL)
    (program,) = (block for block in blocks if "vehicle.move(north, east)" in block)
    assert program.rstrip().endswith("asyncio.run(main())")
    names: dict[str, Callable[[], Awaitable[None]]] = {}
    exec(program.replace("asyncio.run(main())", ""), names)
    return names["main"]


@pytest.mark.flight_cases(2)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("page", PAGES)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_it_flies_twice(page, firmware, monkeypatch):
    async def fly() -> None:
        simulation = Simulation(seed=5)
        copter = simulation.add(VehicleType.COPTER, firmware)
        reduce_telemetry(copter)
        network = MemoryNetwork()
        monkeypatch.setattr(mavstack, "connect", lambda url: connect(network.link()))
        async with running(simulation, network.link()):
            if page == "tutorial":
                await fly_as_in_step_3(connect(network.link()))
            for _ in range(2):
                await main_of(page)()
                assert not copter.autopilot.armed
                assert copter.autopilot.landed

    run_virtually(fly())


async def fly_as_in_step_3(connecting) -> None:
    """Fly as the commands of the tutorial do before its program."""
    async with connecting as connection:
        vehicle = await connection.wait_for_vehicle()
        await vehicle.wait_until_ready()
        await vehicle.arm()
        await vehicle.takeoff(10)
        await vehicle.set_yaw(90)
        await vehicle.rtl()
