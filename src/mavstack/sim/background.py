"""A simulation in a thread of its own, for programs and tests without an event loop.

    with BackgroundSimulator("copter", "px4") as target:
        connection = mavutil.mavlink_connection(target.url)

The vehicles listen on a free UDP port of this machine; clients connect to `url`. With `airborne=True` the
first vehicle has taken off before the port opens: that flight is simulated as fast as possible.
"""

from __future__ import annotations

from secrets import randbits
from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import InvalidStateError
from mavstack.links import Impairment, impair, open_link
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import take_off
from mavstack.sim.simulation import SITE_BITS, Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack.sim.vehicle import SimulatedVehicle

Result = TypeVar("Result")

#: The long idle timeout keeps the link to a script that sends one packet and then only listens.
LINK = "udpin://127.0.0.1:0?idle=600"


class BackgroundSimulator:
    """One or several simulated vehicles of one type, in a thread.

    Use it as a context manager, or call `start` and `stop`.

    Args:
        vehicle_type: The vehicle type, such as "copter".
        firmware: The firmware, "ardupilot" or "px4".
        count: The number of vehicles; their system ids count from 1.
        home: The home position of all vehicles.
        seed: The seed of wind, noise and all other random numbers.
        speed: Simulated seconds per second.
        link: The link URL of the vehicles.
        airborne: True to start with the first vehicle in the air.
        loss: Probability that a datagram is lost, in each direction, 0 to 1.
        latency: Delay in each direction, seconds.
        bandwidth: Bytes per second in each direction; 0 is unlimited.

    Raises:
        InvalidArgumentError: An argument is out of range.
    """

    def __init__(
        self,
        vehicle_type: VehicleType | str = VehicleType.COPTER,
        firmware: Firmware | str = Firmware.ARDUPILOT,
        *,
        count: int = 1,
        home: Home = DEFAULT_HOME,
        seed: int = 1,
        speed: float = 1.0,
        link: str = LINK,
        airborne: bool = False,
        loss: float = 0.0,
        latency: float = 0.0,
        bandwidth: float = 0.0,
    ) -> None:
        self._impairment = Impairment(loss=loss, latency=latency, bandwidth=bandwidth, seed=seed)
        self._impaired = bool(loss or latency or bandwidth)
        self.simulation = Simulation(seed=seed, site=randbits(SITE_BITS))
        for _ in range(count):
            self.simulation.add(vehicle_type, firmware, home=home)
        if airborne:
            take_off(self.simulation, self.vehicle)
        self.port = 0
        self._speed = speed
        self._link = link
        self._portal: BlockingPortal | None = None
        self._runner: Runner | None = None

    @property
    def vehicle(self) -> SimulatedVehicle:
        """The first vehicle. Read it freely; change it only through `call`."""
        return self.simulation.vehicles[0]

    @property
    def url(self) -> str:
        """The address for clients, in the form that pymavlink and MAVProxy understand."""
        return f"udpout:127.0.0.1:{self.port}"

    def start(self) -> Self:
        """Start the simulation and open the port.

        Returns:
            The simulator itself.

        Raises:
            LinkError: The link cannot be opened.
        """
        self._portal = BlockingPortal()
        try:
            self._portal.wait(self._open())
        except BaseException:
            self.stop()
            raise
        return self

    def stop(self) -> None:
        """Stop the simulation. Idempotent."""
        portal, self._portal = self._portal, None
        runner, self._runner = self._runner, None
        if portal is not None:
            if runner is not None:
                portal.wait(runner.close())
            portal.close()
        self.simulation.close()

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a function between two steps of the simulation, such as one that injects a fault.

        Args:
            function: The function, called in the simulation's thread.

        Returns:
            The result of the function.

        Raises:
            InvalidStateError: The simulation is not running.
        """
        if self._portal is None:
            raise InvalidStateError(
                "calling a function failed: the simulation is not running; use `with` or `start`"
            )
        return self._portal.call(function)

    async def _open(self) -> None:
        self._runner = Runner(self.simulation, speed=self._speed)
        link = open_link(self._link)
        if self._impaired:
            link = impair(link, self._impairment)
        link = await self._runner.connect(link, self.simulation.vehicles)
        self.port = (link.address or ("", 0))[1]
        self._runner.start()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
