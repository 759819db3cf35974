"""Pytest fixtures with simulated vehicles, for tests of any MAVLink software.

    def test_my_ground_station(vehicle):                    # a copter on a UDP port, in real time
        connection = mavutil.mavlink_connection(vehicle.url)

    @pytest.mark.vehicle(vehicle_type="plane", firmware="px4")
    def test_a_plane(flying_vehicle): ...                   # a plane in the air

    def test_virtually(virtual_vehicle):                    # minutes of flight in a moment
        async def flight(remote):
            await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)

        virtual_vehicle.run(flight)

The marker has the keyword arguments of `mavstack.sim.BackgroundSimulator`.
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
    """Register the marker."""
    config.addinivalue_line(
        "markers",
        "vehicle(vehicle_type, firmware, ...): options of the simulated vehicle of mavstack's fixtures",
    )


def _marker_options(request: pytest.FixtureRequest) -> dict[str, Any]:
    marker = request.node.get_closest_marker("vehicle")
    return dict(marker.kwargs) if marker else {}


@pytest.fixture
def vehicle(request: pytest.FixtureRequest) -> Iterator[BackgroundSimulator]:
    """Provide a simulated vehicle on a local UDP port, in real time.

    Yields:
        The simulator; `vehicle.url` is the address for clients.
    """
    from mavstack.sim.background import BackgroundSimulator

    with BackgroundSimulator(**_marker_options(request)) as running:
        yield running


@pytest.fixture
def flying_vehicle(request: pytest.FixtureRequest) -> Iterator[BackgroundSimulator]:
    """Provide a simulated vehicle in the air on a local UDP port, in real time.

    Yields:
        The simulator; `flying_vehicle.url` is the address for clients.
    """
    from mavstack.sim.background import BackgroundSimulator

    with BackgroundSimulator(**_marker_options(request), airborne=True) as running:
        yield running


@pytest.fixture
def virtual_vehicle(request: pytest.FixtureRequest) -> VirtualVehicle:
    """Provide a simulated vehicle in virtual time, with a ground station.

    Returns:
        The vehicle; its `run` flies it.
    """
    return VirtualVehicle(**_marker_options(request))


class VirtualVehicle:
    """A simulated vehicle in virtual time; `run` flies it."""

    def __init__(self, vehicle_type: str = "copter", firmware: str = "ardupilot", *, seed: int = 1) -> None:
        from mavstack.sim.simulation import Simulation

        self.simulation: Simulation = Simulation(seed=seed)
        self.vehicle: SimulatedVehicle = self.simulation.add(vehicle_type, firmware)

    def run(self, flight: Callable[[RemoteComponent], Awaitable[Result]]) -> Result:
        """Run a coroutine function in virtual time.

        Args:
            flight: Called with the vehicle's component, as a ground station has it.

        Returns:
            The result of the coroutine.
        """
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
                running.result()  # an error of the simulation fails the test
        return result
