"""The monitor of an action: a vehicle acknowledges an action at once and completes it much later.

    accepted ── goal reached ──────────────────► done
      ├── another mode, disarmed in the air ──► ActionInterrupted, with the vehicle's status texts
      ├── no heartbeat ───────────────────────► ContactLost
      ├── the connection is closed ───────────► RemoteCancelled
      ├── the goal is out of reach ───────────► ActionTimeout
      └── `timeout`, or progress stalls ──────► ActionTimeout

There is no default timeout, since the duration of a flight is not known; an action fails when its progress
stalls: when `remaining`, in metres or another number that falls, does not fall.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionTimeout, ContactLost, RemoteCancelled
from mavstack.services.arguments import check_timeout
from mavstack.vehicle.status_text_capture import StatusTextCapture

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.dialects import Message
    from mavstack.errors import RemoteError
    from mavstack.vehicle.vehicle import Vehicle

#: The time without progress after which an action fails, in seconds.
STALL_TIMEOUT = 30.0
#: Minimum decrease of `remaining` that counts as progress.
MIN_PROGRESS = 0.5
#: A remaining amount below this is reported with a decimal place.
_WHOLE_NUMBERS = 2.0
#: The interval at which the goal is checked if no packet arrives, in seconds.
CHECK_INTERVAL = 0.5
#: The time in which the vehicle may still report its former mode, in seconds.
SETTLING_TIME = 3.0
#: The time in another mode after which the action counts as interrupted, in seconds: at the end of an action
#: some vehicles change their mode before they report that the action ended.
INTERRUPTION_DELAY = 1.5

#: The messages that report the progress of an action, and their rates in hertz.
MONITORED_RATES: dict[type[Message], float] = {common.GlobalPositionInt: 4.0, common.ExtendedSysState: 2.0}

logger = logging.getLogger("mavstack.vehicle")


@dataclass
class ActionGoal:
    """The goal of an action.

    Attributes:
        reached: Returns whether the action is complete.
        remaining: Returns the rest in `unit`; None if it is not known.
        unit: The unit of `remaining`.
        modes: The modes in which the action goes on, in lower case; None: any mode.
        armed: The armed state in which the action goes on; None: either.
        stall_timeout: The time without progress after which the action fails, in seconds.
        signs: Returns a value that changes with every other sign of progress.
        min_progress: A smaller fall of `remaining` is no progress.
        detail: Returns what keeps the action from its end, for the error; empty if nothing is known.
        failure: Returns why the goal is out of reach; None as long as it is not.
        may_be_silent: True if the vehicle may be silent meanwhile, such as during a power cycle.
    """

    reached: Callable[[], bool]
    remaining: Callable[[], float | None] = field(default=lambda: None)
    unit: str = "m"
    modes: Container[str] | None = None
    armed: bool | None = None
    stall_timeout: float = STALL_TIMEOUT
    signs: Callable[[], object] = field(default=lambda: None)
    min_progress: float = MIN_PROGRESS
    detail: Callable[[], str] = field(default=lambda: "")
    failure: Callable[[], str | None] = field(default=lambda: None)
    may_be_silent: bool = False


class ActionMonitor:
    """Monitors one action. Enter it before the action is requested, so that no report is missed.

    `timeout` covers the whole block, in seconds; None sets no overall limit. `rates` are the messages to
    request, in hertz.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        operation: str,
        timeout: float | None = None,
        *,
        rates: Mapping[type[Message], float] = MONITORED_RATES,
    ) -> None:
        check_timeout(timeout)
        self._vehicle = vehicle
        self._operation = operation
        self._timeout = timeout
        self._rates = rates
        self._timer = asyncio.timeout(timeout)
        self._connection = vehicle.connection
        self._texts = StatusTextCapture(vehicle)
        self._packet_arrived = asyncio.Event()
        self._interrupted_at: float | None = None
        #: False if the vehicle was disarmed all the time.
        self._has_been_armed = vehicle.armed is not False
        self._goal: ActionGoal | None = None
        self._listener = vehicle.connection.add_packet_listener(
            None, lambda _: self._packet_arrived.set(), system=vehicle.system
        )

    async def wait_until_reached(self, goal: ActionGoal) -> None:
        """Wait until the goal is reached.

        Raises:
            ActionTimeout: Progress stalled, or the goal is out of reach.
            ActionInterrupted: The vehicle changed its mode, or was armed or disarmed.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        self._goal = goal
        self._check_connection()
        started = progressed = self._connection.now()
        nearest, signs = inf, goal.signs()
        while not goal.reached():
            now = self._connection.now()
            remaining = goal.remaining()
            if remaining is not None and remaining < nearest - goal.min_progress:
                nearest, progressed = remaining, now
            if (latest := goal.signs()) != signs:
                signs, progressed = latest, now
            self._check_vehicle(goal, started, now)
            if (failure := goal.failure()) is not None:
                raise self.error(ActionTimeout, failure)
            if now >= progressed + goal.stall_timeout:
                raise self._timed_out(f"no progress for {goal.stall_timeout:g} s")
            await self._wait()
            self._check_connection()

    def _check_connection(self) -> None:
        if not self._connection.is_open:
            raise self.error(RemoteCancelled, "the connection was closed")

    def _check_vehicle(self, goal: ActionGoal, started: float, now: float) -> None:
        self._has_been_armed |= bool(self._vehicle.armed)
        if not self._vehicle.alive and not goal.may_be_silent:
            raise self.error(ContactLost, "it fell silent")
        interruption = self._interruption(goal) if now >= started + SETTLING_TIME else None
        if interruption is None:
            self._interrupted_at = None
        elif self._interrupted_at is None:
            self._interrupted_at = now
        elif now >= self._interrupted_at + INTERRUPTION_DELAY:
            raise self.error(ActionInterrupted, interruption)

    def _interruption(self, goal: ActionGoal) -> str | None:
        """Return how the vehicle left the action; None if it did not."""
        mode, armed = self._vehicle.mode, self._vehicle.armed
        if goal.modes is not None and mode is not None and mode.lower() not in goal.modes:
            return f"it changed to {mode}"
        if goal.armed is not None and armed is not None and armed != goal.armed:
            if not self._has_been_armed:
                return "it is not armed"
            return "it was armed" if armed else f"it was disarmed{self._height()}"
        return None

    def _height(self) -> str:
        """Return where a vehicle was disarmed that did not land, for the error."""
        position = self._vehicle.position
        if position is None or position.relative_altitude is None or not self._vehicle.vehicle_type.flies:
            return ""
        return f" {position.relative_altitude:.0f} m above home"

    def _timed_out(self, reason: str) -> RemoteError:
        goal = self._goal
        remaining = None if goal is None else goal.remaining()
        if goal is not None and remaining is not None:
            digits = 0 if remaining >= _WHOLE_NUMBERS else 1
            reason += f", {remaining:.{digits}f} {goal.unit} to go"
        if goal is not None and (detail := goal.detail()):
            reason += f"; {detail}"
        return self.error(ActionTimeout, reason)

    def error(self, kind: type[RemoteError], answer: str) -> RemoteError:
        """Return an error of the action with the vehicle's warnings."""
        error = kind(self._operation, str(self._vehicle.address), answer=answer)
        error.status_texts = self._texts.warnings
        return error

    async def _wait(self) -> None:
        self._packet_arrived.clear()
        with suppress(TimeoutError):
            async with asyncio.timeout(CHECK_INTERVAL):
                await self._packet_arrived.wait()

    async def __aenter__(self) -> Self:
        try:
            self._connection.now()  # raises if the connection is closed, before rates are requested
        except BaseException:
            self._close()
            raise
        await self._timer.__aenter__()
        logger.debug("%s %s started", self._operation, self._vehicle.address)
        try:
            for message, rate in self._rates.items():
                await self._vehicle.telemetry.ensure(message, rate)
        except BaseException as error:
            await self.__aexit__(type(error), error, error.__traceback__)
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            await self._timer.__aexit__(kind, error, trace)
        except TimeoutError:
            raise self._timed_out(f"not done in {self._timeout:g} s") from None
        finally:
            outcome = "done" if kind is None else f"ended by {kind.__name__}"
            logger.debug("%s %s %s", self._operation, self._vehicle.address, outcome)
            self._close()

    def _close(self) -> None:
        self._listener.close()
        self._texts.close()
