"""A simulator: the world of one vehicle, behind the interface that its firmware expects.

    async with Px4Simulator("copter", home=home) as simulator:
        simulator.inject("gps-lost", after=20, duration=5)
        await simulator.run(speed=0, until=60)        # simulated seconds

A subclass owns the sockets of one interface. It calls `_begin` before each step: the step begins at once, or
later by the pace, or after a pause.
"""

from __future__ import annotations

import asyncio
import logging
import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Final, Self

from mavstack.errors import InvalidArgumentError
from mavstack.links import parse_url
from mavstack.simulators.pace import Pace
from mavstack.simulators.physics import load_physics
from mavstack.simulators.sensors import Sensors

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import TracebackType

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.sensor_model import SensorModels
    from mavstack.simulators.sensors import SensorSource
    from mavstack.simulators.state import State

#: Logger of all simulators.
log: Final = logging.getLogger("mavstack.simulators")


class Simulator(ABC):
    """The world of one vehicle.

    Args:
        physics: The name of the physics; see `load_physics`.
        home: The place and heading of the vehicle at the start.
        speed: Simulated seconds in a real second; 0: as fast as the firmware answers.
        seed: Seed of the sensors' noise.
        models: The errors of the sensors; None: those of a low-cost autopilot.
        equipment: Sensors beside the usual ones: "rangefinder", "optical-flow".
        on_connect: Called with a line when the firmware connects, and at the next stages.

    Attributes:
        home: The place and heading at the start.
        sensors: The sensors and their faults.
        pace: Speed, pauses and single steps.
        state: The state of the body.

    Raises:
        InvalidArgumentError: An argument is wrong; the text says which.
    """

    def __init__(
        self,
        physics: str,
        *,
        home: Home,
        speed: float,
        seed: int = 1,
        models: SensorModels | None = None,
        equipment: Iterable[str] = (),
        on_connect: Callable[[str], None] = lambda line: None,
    ) -> None:
        self._physics, self._outputs = load_physics(physics)
        self.home, self._report = home, on_connect
        recorded = getattr(self._physics, "sensors", None)
        self.sensors: SensorSource = (
            recorded(home) if recorded else Sensors(home, seed, models=models, equipment=equipment)
        )
        self.pace = Pace(speed, self._resumed)
        self.state: State = self._physics.reset(home, home.heading).checked()
        self._until = math.inf
        self._ended: asyncio.Future[None] | None = None
        self._waiting: Callable[[], None] | None = None
        self._timer: asyncio.TimerHandle | None = None

    @property
    @abstractmethod
    def time(self) -> float:
        """Seconds of the simulation."""

    @property
    @abstractmethod
    def port(self) -> int:
        """The port on which it listens; 0: none."""

    @property
    @abstractmethod
    def status(self) -> str:
        """The event that each side waits for, in a sentence."""

    @abstractmethod
    async def _open(self) -> None:
        """Open the sockets."""

    @abstractmethod
    async def _close(self) -> None:
        """Close the sockets."""

    @abstractmethod
    def _start(self) -> None:
        """Begin to run, or continue."""

    async def run(self, *, speed: float | None = None, until: float | None = None) -> None:
        """Wait for the firmware, and simulate.

        Args:
            speed: Simulated seconds in a real second; 0: as fast as the firmware answers; None: as before.
            until: Seconds of the simulation after which it ends; None: when the firmware disconnects.

        Raises:
            InvalidArgumentError: The speed is negative or not finite, or the physics failed.
            LinkError: The firmware disconnected before that time.
        """
        if speed is not None:
            self.pace.speed = speed
        self._until = math.inf if until is None else until
        if self.time >= self._until:
            return
        self._ended = asyncio.get_running_loop().create_future()
        self._start()
        try:
            await self._ended
        finally:
            self._ended = None
            self._cancel_timer()

    def pause(self, steps: int = 0) -> None:
        """Pause after some more steps; the firmware waits too where it runs in lockstep."""
        self.pace.pause(steps)

    def resume(self) -> None:
        """Continue after a pause."""
        self.pace.resume()

    def inject(self, fault: str, *, after: float = 0.0, duration: float | None = None) -> None:
        """Inject a fault of a sensor.

        Args:
            fault: A name of `FAULTS`.
            after: Simulated seconds from now until it begins.
            duration: Simulated seconds that it lasts; None: until `clear`.

        Raises:
            InvalidArgumentError: There is no such fault, or a time is wrong.
        """
        self.sensors.faults.inject(fault, after=after, duration=duration)

    def clear(self, fault: str | None = None) -> None:
        """End a fault; None: all of them."""
        self.sensors.faults.clear(fault)

    async def __aenter__(self) -> Self:
        await self._open()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._cancel_timer()
        await self._close()

    # For subclasses

    def _begin(self, step: Callable[[], None]) -> None:
        """Let a step begin when the run, the pace and the pauses allow it."""
        ended = self._ended
        if ended is None or ended.done():
            self._waiting = step
            return
        if self.time >= self._until:
            self._waiting = step
            ended.set_result(None)
            return
        delay = self.pace.delay(self.time, asyncio.get_running_loop().time())
        if delay == 0.0:
            self._make(step)
        else:
            self._waiting = step
            if delay is not None:
                self._cancel_timer()
                self._timer = asyncio.get_running_loop().call_later(delay, self._resumed)

    def _resumed(self) -> None:
        """Begin the step that waits, if there is one."""
        step, self._waiting = self._waiting, None
        self._cancel_timer()
        if step is not None:
            self._begin(step)

    def _make(self, step: Callable[[], None]) -> None:
        self.pace.count()
        try:
            step()
        except Exception as error:  # noqa: BLE001 (of a user's physics)
            self._end(error)

    def _end(self, error: Exception | None = None) -> None:
        """End the run."""
        if self._ended is not None and not self._ended.done():
            if error is None:
                self._ended.set_result(None)
            else:
                self._ended.set_exception(error)

    def _move(self, actuators: Sequence[float], dt: float) -> None:
        """Move the body."""
        self.state = self._physics.step(actuators, dt).checked()

    def _place(self) -> None:
        """Put the body at home, and restart the sensors."""
        self.state = self._physics.reset(self.home, self.home.heading).checked()
        self.sensors.reset()

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def listen_address(url: str, scheme: str) -> tuple[str, int]:
    """Return host and port of a URL that must have a scheme.

    Raises:
        InvalidArgumentError: It has another scheme, or no host or port.
    """
    parsed = parse_url(url)
    if parsed.scheme != scheme or parsed.host is None or parsed.port is None:
        raise InvalidArgumentError(f"{url!r} must be {scheme}://HOST:PORT")
    return parsed.host, parsed.port
