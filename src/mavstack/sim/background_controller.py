"""A simulated flight controller that speaks MSP, in a thread of its own.

    with BackgroundFlightController("inav") as target:
        controller = mavstack.sync.connect(target.url)

It is for programs and tests without an event loop, as `BackgroundSimulator` is for vehicles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import InvalidStateError
from mavstack.node.blocking_portal import BlockingPortal
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, ControllerFirmware, Home

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

Result = TypeVar("Result")

_LINK = "msp+tcpin://127.0.0.1:0"


class BackgroundFlightController:
    """A copter with Betaflight or iNav on a free TCP port of this machine; a context manager.

    Args:
        firmware: The firmware, "betaflight" or "inav".
        home: The start position.
        seed: The seed of wind, noise and all other random numbers.
        speed: Simulated seconds per second.

    Attributes:
        simulation: The simulation.
        controller: The flight controller. Read it freely; change it only through `call`.
        port: The TCP port.

    Raises:
        InvalidArgumentError: An argument is out of range.
    """

    def __init__(
        self,
        firmware: ControllerFirmware | str = ControllerFirmware.BETAFLIGHT,
        *,
        home: Home = DEFAULT_HOME,
        seed: int = 1,
        speed: float = 1.0,
    ) -> None:
        self.simulation = Simulation(seed=seed)
        self.controller = self.simulation.add_flight_controller(firmware, home=home)
        self.port = 0
        self._speed = speed
        self._portal: BlockingPortal | None = None
        self._runner: Runner | None = None

    @property
    def url(self) -> str:
        """The URL for clients of Mavstack."""
        return f"msp+tcp://127.0.0.1:{self.port}"

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a function between two steps of the simulation, and return its result.

        Args:
            function: The function, called in the simulation's thread.

        Raises:
            InvalidStateError: The simulation is not running.
        """
        if self._portal is None:
            raise InvalidStateError("calling a function failed: the simulation is not running; use `with`")
        return self._portal.call(function)

    async def _open(self) -> None:
        self._runner = Runner(self.simulation, speed=self._speed)
        link = await self._runner.connect(_LINK, self.simulation.flight_controllers)
        self.port = (link.address or ("", 0))[1]
        self._runner.start()

    def __enter__(self) -> Self:
        self._portal = BlockingPortal()
        try:
            self._portal.wait(self._open())
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        portal, self._portal = self._portal, None
        runner, self._runner = self._runner, None
        if portal is not None:
            if runner is not None:
                portal.wait(runner.close())
            portal.close()
        self.simulation.close()
