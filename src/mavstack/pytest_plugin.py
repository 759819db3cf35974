"""Fixtures for the tests of anybody's MAVLink software; they come with this package.

    def test_my_ground_station(vehicle):                    # a copter on a UDP port, in real time
        connection = mavutil.mavlink_connection(vehicle.url)

    @pytest.mark.vehicle(type="plane", firmware="px4")      # another one
    def test_a_plane(flying_vehicle): ...                   # it is in the air already

    def test_virtually(virtual_vehicle):                    # minutes of flight in a moment
        async def flight(remote):
            await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)

        virtual_vehicle.run(flight)

The marker takes what `mavstack.sim.BackgroundSimulator` takes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import pytest

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

    from mavstack.node import RemoteComponent
    from mavstack.sim.background import BackgroundSimulator
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

Result = TypeVar("Result")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker."""
    config.addinivalue_line(
        "markers", "vehicle(type, firmware, ...): which simulated vehicle the fixtures of mavstack give"
    )


def _wishes(request: pytest.FixtureRequest) -> dict[str, Any]:
    marker = request.node.get_closest_marker("vehicle")
    return dict(marker.kwargs) if marker else {}


@pytest.fixture
def vehicle(request: pytest.FixtureRequest) -> Iterator[BackgroundSimulator]:
    """A simulated vehicle on a UDP port of this machine, `vehicle.url`, in real time."""
    from mavstack.sim.background import BackgroundSimulator

    with BackgroundSimulator(**_wishes(request)) as running:
        yield running


@pytest.fixture
def flying_vehicle(request: pytest.FixtureRequest) -> Iterator[BackgroundSimulator]:
    """The same, in the air."""
    from mavstack.sim.background import BackgroundSimulator

    with BackgroundSimulator(**_wishes(request), airborne=True) as running:
        yield running


@pytest.fixture
def virtual_vehicle(request: pytest.FixtureRequest) -> VirtualVehicle:
    """A simulated vehicle in virtual time, and a ground station that talks to it."""
    return VirtualVehicle(**_wishes(request))


class VirtualVehicle:
    """A vehicle, and `run` to fly it in virtual time."""

    def __init__(self, type: str = "copter", firmware: str = "ardupilot", *, seed: int = 1) -> None:  # noqa: A002
        from mavstack.sim.simulation import Simulation

        self.simulation: Simulation = Simulation(seed=seed)
        self.vehicle: SimulatedVehicle = self.simulation.add(type, firmware)

    def run(self, flight: Callable[[RemoteComponent], Awaitable[Result]]) -> Result:
        """Run a coroutine function with the vehicle as a ground station sees it."""
        from mavstack.sim.virtual import run_virtually

        return run_virtually(self._fly(flight))

    async def _fly(self, flight: Callable[[RemoteComponent], Awaitable[Result]]) -> Result:
        from mavstack.links import MemoryNetwork
        from mavstack.node import Node
        from mavstack.sim.runner import Runner

        network = MemoryNetwork()
        async with Runner(self.simulation) as runner:
            await runner.connect(network.link(), [self.vehicle])
            running = runner.start()
            async with Node(network.link()) as ground:
                result = await flight(await ground.wait_for_autopilot())
            if running.done():
                running.result()  # what went wrong in the simulation is what the test should tell
        return result
