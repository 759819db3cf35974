"""A simulation that runs beside a program or a test that has no event loop: in a thread of its own.

    with BackgroundSimulator("copter", "px4") as target:
        connection = mavutil.mavlink_connection(target.url)

The vehicles listen on a free port of this machine; `url` is what clients connect to. With `airborne=True` the
first one has taken off before anybody sees it: that part is simulated as fast as it can be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import MavstackError
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import take_off
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack.sim.vehicle import SimulatedVehicle

Result = TypeVar("Result")

#: Scripts that only listen say something once, and go on listening for long.
LINK = "udpin://127.0.0.1:0?idle=600"


class BackgroundSimulator:
    """One simulated vehicle, or several of a kind, in a thread."""

    def __init__(
        self,
        type: VehicleType | str = VehicleType.COPTER,  # noqa: A002 (HEARTBEAT's name for it)
        firmware: Firmware | str = Firmware.ARDUPILOT,
        *,
        count: int = 1,
        home: Home = DEFAULT_HOME,
        seed: int = 1,
        speed: float = 1.0,
        link: str = LINK,
        airborne: bool = False,
    ) -> None:
        self.simulation = Simulation(seed=seed)
        for _ in range(count):
            self.simulation.add(type, firmware, home=home)
        if airborne:
            take_off(self.simulation, self.vehicle)
        self.port = 0
        self._speed = speed
        self._link = link
        self._portal: BlockingPortal | None = None
        self._runner: Runner | None = None

    @property
    def vehicle(self) -> SimulatedVehicle:
        """The first vehicle; look at it freely, but change it only by `call`."""
        return self.simulation.vehicles[0]

    @property
    def url(self) -> str:
        """Where clients find the vehicles, in the form that pymavlink and MAVProxy understand."""
        return f"udpout:127.0.0.1:{self.port}"

    def start(self) -> Self:
        """Begin; returns when the port is open."""
        self._portal = BlockingPortal()
        try:
            self._portal.wait(self._open())
        except BaseException:
            self.stop()
            raise
        return self

    def stop(self) -> None:
        """End; stopping twice does nothing."""
        portal, self._portal = self._portal, None
        runner, self._runner = self._runner, None
        if portal is not None:
            if runner is not None:
                portal.wait(runner.close())
            portal.close()
        self.simulation.close()

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a function between two steps of the simulation, such as one that injects a fault."""
        if self._portal is None:
            raise MavstackError("the simulation does not run: use `with` or `start`")
        return self._portal.call(function)

    async def _open(self) -> None:
        self._runner = Runner(self.simulation, speed=self._speed)
        link = await self._runner.connect(self._link, self.simulation.vehicles)
        self.port = (link.address or ("", 0))[1]
        self._runner.start()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
