"""Seeing an action through: a vehicle acknowledges at once, and does what it took on over seconds or minutes.

    accepted ── reached ───────────────────► done
      ├── another mode, disarmed in the air ──► ActionInterrupted, with what the vehicle said
      ├── silence ────────────────────────────► ContactLost
      ├── the connection is closed ───────────► RemoteCancelled
      └── `limit`, or no progress for long ───► ActionTimeout

There is no usual limit, since how long a flight takes nobody knows; what is watched instead is that it gets
on: `remaining` (metres, or any number that gets smaller) has to fall.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionTimeout, ContactLost, RemoteCancelled
from mavstack.vehicle.status_text_capture import StatusTextCapture

if TYPE_CHECKING:
    from collections.abc import Callable, Container
    from types import TracebackType
    from typing import Self

    from mavstack.dialects import Message
    from mavstack.errors import RemoteError
    from mavstack.vehicle.vehicle import Vehicle

#: Without getting nearer for so many seconds it does not get on.
PATIENCE = 30.0
#: Getting nearer by less does not count.
STEP = 0.5
#: How often to look if nothing is heard.
TICK = 0.5
#: For so long after it was asked a vehicle may still be in the mode that it was in.
SETTLING = 3.0
#: For so long it has to do something else: at the end of an action some change their mode before they say
#: that it has ended.
AFTER_ALL = 1.5

#: What tells how a vehicle gets on, and how often it has to, in hertz.
TOLD_BY: dict[type[Message], float] = {common.GlobalPositionInt: 4.0, common.ExtendedSysState: 2.0}


@dataclass
class ActionGoal:
    """What an action comes to.

    `reached` says whether it is done; `remaining` gives what is left, or None if that is not known. `modes`
    are those it goes on in, lower-cased; `armed` is what it has to stay, or None if either will do; `unit` is
    what `remaining` counts.
    """

    what: str
    reached: Callable[[], bool]
    remaining: Callable[[], float | None] = field(default=lambda: None)
    unit: str = "m"
    modes: Container[str] | None = None
    armed: bool | None = None
    limit: float | None = None
    patience: float = PATIENCE


class ActionMonitor:
    """Watches one action; enter it before the vehicle is asked, so that nothing is missed."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._node = vehicle.connection
        self._listener = StatusTextCapture(vehicle)
        self._news = asyncio.Event()
        self._strayed_at: float | None = None
        self._listening = vehicle.connection.add_packet_listener(
            None, lambda _: self._news.set(), system=vehicle.system
        )

    async def until(self, aim: ActionGoal) -> None:
        """Wait until it is reached; raises `ActionTimeout`, `ActionInterrupted`, `ContactLost` or, if the
        connection is closed meanwhile, `RemoteCancelled`.
        """
        self._check_connection(aim)
        begun = moved = self._node.now()
        nearest = inf
        while not aim.reached():
            now = self._node.now()
            left = aim.remaining()
            if left is not None and left < nearest - STEP:
                nearest, moved = left, now
            self._check_vehicle(aim, begun, now)
            if now >= begun + (inf if aim.limit is None else aim.limit):
                raise self._timeout(aim, f"not done in {aim.limit:g} s", left)
            if now >= moved + aim.patience:
                raise self._timeout(aim, f"got no further for {aim.patience:g} s", left)
            await self._wait()
            self._check_connection(aim)

    def _check_connection(self, aim: ActionGoal) -> None:
        if not self._node.is_open:
            raise self._ended(RemoteCancelled, aim, "the connection was closed")

    def _check_vehicle(self, aim: ActionGoal, begun: float, now: float) -> None:
        vehicle = self._vehicle
        if not vehicle.alive:
            raise self._ended(ContactLost, aim, "it fell silent")
        how = self._strays(aim) if now >= begun + SETTLING else None
        if how is None:
            self._strayed_at = None
        elif self._strayed_at is None:
            self._strayed_at = now
        elif now >= self._strayed_at + AFTER_ALL:
            raise self._ended(ActionInterrupted, aim, how)

    def _strays(self, aim: ActionGoal) -> str | None:
        """How it does something else, if it does."""
        mode, armed = self._vehicle.mode, self._vehicle.armed
        if aim.modes is not None and mode is not None and mode.lower() not in aim.modes:
            return f"it changed to {mode}"
        if aim.armed is not None and armed is not None and armed != aim.armed:
            return "it was armed" if armed else "it was disarmed"
        return None

    def _timeout(self, aim: ActionGoal, why: str, left: float | None) -> RemoteError:
        still = "" if left is None else f", {left:.0f} {aim.unit} to go"
        return self._ended(ActionTimeout, aim, why + still)

    def _ended(self, kind: type[RemoteError], aim: ActionGoal, how: str) -> RemoteError:
        error = kind(aim.what, str(self._vehicle.address), answer=how)
        error.status_texts = self._listener.warnings
        return error

    async def _wait(self) -> None:
        self._news.clear()
        with suppress(TimeoutError):
            async with asyncio.timeout(TICK):
                await self._news.wait()

    async def __aenter__(self) -> Self:
        try:
            self._node.now()  # raises if there is no connection, before rates are wished for
            for kind, rate in TOLD_BY.items():
                await self._vehicle.telemetry.ensure(kind, rate)
        except BaseException:
            self._close()
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._close()

    def _close(self) -> None:
        self._listening.close()
        self._listener.close()
