"""Pytest fixtures with simulated vehicles, for tests of any MAVLink software.

    def test_my_ground_station(vehicle):                    # a copter on a UDP port, in real time
        connection = mavutil.mavlink_connection(vehicle.url)

    @pytest.mark.vehicle(vehicle_type="plane", firmware="px4")
    def test_a_plane(flying_vehicle): ...                   # a plane in the air

    def test_virtually(virtual_vehicle):                    # minutes of flight in a moment
        async def flight(vehicle):                          # a mavstack.Vehicle
            await vehicle.wait_until_ready()
            await vehicle.arm()
            await vehicle.takeoff(10)

        virtual_vehicle.run(flight)

    @pytest.mark.vehicle(loss=0.1, latency=0.2, bandwidth=5760)
    def test_over_a_radio(virtual_vehicle): ...             # with a lossy and slow link

    @pytest.mark.vehicle(firmware="inav")                   # a flight controller that speaks MSP
    def test_my_configurator(flight_controller):
        configurator = Configurator(port=flight_controller.port)

    def test_real_firmware(firmware):                       # a SITL that you have built, in our world
        flight = firmware("ardupilot", "build/sitl/bin/arduplane", vehicle="plane", speed=10)
        connection = mavutil.mavlink_connection(flight.url)

    def test_my_uploader(bootloader):                       # a board without firmware
        upload("firmware.px4", bootloader.port)
        assert bootloader.has_firmware

The marker has the keyword arguments of `mavstack.sim.BackgroundSimulator`, for `virtual_vehicle` those of
`VirtualVehicle`, for `flight_controller` those of `BackgroundFlightController`, for `bootloader` those of
`mavstack.flashing.background_board.BackgroundBoard`.
"""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, TypeVar

import pytest

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

    from mavstack.flashing.background_board import BackgroundBoard
    from mavstack.links import Link
    from mavstack.sim.background import BackgroundSimulator
    from mavstack.sim.background_controller import BackgroundFlightController
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.background_firmware import BackgroundFirmware
    from mavstack.vehicle import Vehicle

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
def flight_controller(request: pytest.FixtureRequest) -> Iterator[BackgroundFlightController]:
    """Provide a simulated flight controller with Betaflight or iNav on a local TCP port, in real time.

    Yields:
        The flight controller; `flight_controller.url` is the URL for clients, `port` the TCP port.
    """
    from mavstack.sim.background_controller import BackgroundFlightController

    with BackgroundFlightController(**_marker_options(request)) as running:
        yield running


@pytest.fixture
def bootloader(request: pytest.FixtureRequest) -> Iterator[BackgroundBoard]:
    """Provide a board in its bootloader on a pseudo terminal, in real time.

    Yields:
        The board; `bootloader.port` is the path of the terminal for uploaders.
    """
    from mavstack.flashing.background_board import BackgroundBoard

    with BackgroundBoard(**_marker_options(request)) as running:
        yield running


@pytest.fixture
def firmware() -> Iterator[Callable[..., BackgroundFirmware]]:
    """Provide a function that starts real firmware in a simulated world.

    Its arguments are the firmware ("px4", "ardupilot", "betaflight"), the path of its program (None: you
    start it), and those of `mavstack.simulators.FirmwareOptions`.

    Yields:
        The function; what it returns has `url`, `simulator`, `inject`, `lines` and `events`.
    """
    from mavstack.simulators.background_firmware import BackgroundFirmware
    from mavstack.simulators.firmware_session import FirmwareOptions

    with ExitStack() as stack:

        def start(
            name: str,
            binary: str | None = None,
            **options: Any,  # noqa: ANN401 (those of FirmwareOptions)
        ) -> BackgroundFirmware:
            flight = BackgroundFirmware(FirmwareOptions(name, binary=binary, **options))
            return stack.enter_context(flight)

        yield start


@pytest.fixture
def virtual_vehicle(request: pytest.FixtureRequest) -> VirtualVehicle:
    """Provide a simulated vehicle in virtual time, with a connection to it.

    Returns:
        The vehicle; its `run` flies it.
    """
    return VirtualVehicle(**_marker_options(request))


class VirtualVehicle:
    """A simulated vehicle in virtual time, and a connection to it; `run` flies it.

    Args:
        vehicle_type: The vehicle type, such as "copter".
        firmware: The firmware, "ardupilot" or "px4".
        home: The home position; None for the default.
        seed: The seed of wind, noise, lost packets and all other random numbers.
        airborne: True to start in the air.
        loss: Probability that a packet is lost, in each direction, 0 to 1.
        latency: Delay in each direction, seconds.
        bandwidth: Bytes per second in each direction; 0 is unlimited.

    Attributes:
        simulation: The simulation.
        vehicle: The simulated vehicle: its true motion, parameters and faults.

    Raises:
        InvalidArgumentError: An argument is out of range.
    """

    def __init__(
        self,
        vehicle_type: str = "copter",
        firmware: str = "ardupilot",
        *,
        home: Home | None = None,
        seed: int = 1,
        airborne: bool = False,
        loss: float = 0.0,
        latency: float = 0.0,
        bandwidth: float = 0.0,
    ) -> None:
        from mavstack.links import Impairment
        from mavstack.sim.scenarios import take_off
        from mavstack.sim.simulation import Simulation
        from mavstack.sim.vehicle_types import DEFAULT_HOME

        self._impairment = Impairment(loss=loss, latency=latency, bandwidth=bandwidth, seed=seed)
        self._impaired = bool(loss or latency or bandwidth)
        self.simulation: Simulation = Simulation(seed=seed)
        self.vehicle: SimulatedVehicle = self.simulation.add(
            vehicle_type, firmware, home=DEFAULT_HOME if home is None else home
        )
        if airborne:
            take_off(self.simulation, self.vehicle)

    def run(self, flight: Callable[[Vehicle], Awaitable[Result]]) -> Result:
        """Run a coroutine function in virtual time.

        Args:
            flight: Called with the vehicle, as `mavstack.connect` finds it.

        Returns:
            The result of the coroutine.
        """
        from mavstack.sim.virtual import run_virtually

        return run_virtually(self._fly(flight))

    async def _fly(self, flight: Callable[[Vehicle], Awaitable[Result]]) -> Result:
        from mavstack.links import MemoryNetwork, impair
        from mavstack.sim.runner import Runner
        from mavstack.vehicle import connect

        network = MemoryNetwork()
        ground: Link = network.link()
        if self._impaired:
            ground = impair(ground, self._impairment)
        async with Runner(self.simulation) as runner:
            await runner.connect(network.link(), [self.vehicle])
            running = runner.start()
            async with connect(ground) as connection:
                result = await flight(await connection.wait_for_vehicle())
            if running.done():
                running.result()  # an error of the simulation fails the test
        return result
