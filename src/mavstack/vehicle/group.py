"""Many vehicles asked as one, and what became of it for each.

    fleet = await node.wait_for_vehicles(50)
    results = await fleet.arm()
    for vehicle, error in results.errors.items(): ...        # why it did not
    results = await fleet.each(lambda vehicle: vehicle.params.set("RTL_ALT", 3000), max_concurrency=10)
    results.check()                                          # GroupError if any failed

All are asked at the same time, or `max_concurrency` of them, and one that fails stops no other: what each came to,
its result or its error, is in the `Results`, also if the error is a defect of the function that was given.
Cancelling the task cancels what is under way on every vehicle, and waits until each end is clean.
"""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Mapping
from contextlib import nullcontext
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.errors import GroupError, LocalProtocolError, RemoteCancelled

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Iterator
    from contextlib import AbstractAsyncContextManager

    from mavstack.vehicle.vehicle import Vehicle

Result = TypeVar("Result")


class Results(Mapping["Vehicle", "Result | Exception"], Generic[Result]):
    """What each vehicle of a group came to: its result, or the error that it ended with."""

    def __init__(self, outcomes: Mapping[Vehicle, Result | Exception], what: str = "work") -> None:
        self._outcomes = dict(outcomes)
        self._what = what

    @property
    def ok(self) -> bool:
        """Whether all did it."""
        return not self.errors

    @property
    def succeeded(self) -> dict[Vehicle, Result]:
        """The results of those that did it."""
        return {
            vehicle: outcome
            for vehicle, outcome in self._outcomes.items()
            if not isinstance(outcome, Exception)
        }

    @property
    def errors(self) -> dict[Vehicle, Exception]:
        """Why the others did not."""
        return {
            vehicle: outcome for vehicle, outcome in self._outcomes.items() if isinstance(outcome, Exception)
        }

    @property
    def failed(self) -> Group:
        """Those that did not, to be asked again."""
        return Group(self.errors)

    def check(self) -> dict[Vehicle, Result]:
        """The results of all; raises `GroupError` if there are errors among them."""
        errors = self.errors
        if not errors:
            return self.succeeded
        by_system = {vehicle.system: error for vehicle, error in errors.items()}
        defect = next((error for error in errors.values() if not GroupError.expects(error)), None)
        raise GroupError(self._what, by_system, len(self)) from defect

    def __getitem__(self, vehicle: Vehicle) -> Result | Exception:
        return self._outcomes[vehicle]

    def __iter__(self) -> Iterator[Vehicle]:
        return iter(self._outcomes)

    def __len__(self) -> int:
        return len(self._outcomes)

    def __repr__(self) -> str:
        errors = {vehicle.system: error for vehicle, error in self.errors.items()}
        told = f"; errors: {errors}" if errors else ""
        return f"<Results of {self._what}: {len(self) - len(errors)} of {len(self)} did it{told}>"


class Group(Collection["Vehicle"]):
    """Several vehicles, each once, in the order in which they were given."""

    def __init__(self, vehicles: Iterable[Vehicle]) -> None:
        self._vehicles = dict.fromkeys(vehicles)

    async def each(
        self,
        work: Callable[[Vehicle], Awaitable[Result]],
        *,
        max_concurrency: int | None = None,
        what: str = "work",
    ) -> Results[Result]:
        """Do something with every vehicle, at the same time or so many `max_concurrency`; `what` names it."""
        if max_concurrency is not None and max_concurrency < 1:
            raise LocalProtocolError(f"a group cannot be asked {max_concurrency} at once")
        turns = None if max_concurrency is None else asyncio.Semaphore(max_concurrency)
        async with asyncio.TaskGroup() as tasks:
            begun = {
                vehicle: tasks.create_task(_outcome(work, vehicle, what, turns or nullcontext()))
                for vehicle in self
            }
        return Results({vehicle: task.result() for vehicle, task in begun.items()}, what)

    # What vehicles can do, done by all of them

    async def arm(self, *, force: bool = False) -> Results[None]:
        """Let the motors of all run; see `Vehicle.arm`."""
        return await self.each(lambda vehicle: vehicle.arm(force=force), name="arming")

    async def disarm(self, *, force: bool = False) -> Results[None]:
        """Stop the motors of all; see `Vehicle.disarm`."""
        return await self.each(lambda vehicle: vehicle.disarm(force=force), name="disarming")

    async def set_mode(self, mode: str | int) -> Results[None]:
        """Let all enter a mode, which each firmware names its own way; see `Vehicle.set_mode`."""
        return await self.each(lambda vehicle: vehicle.set_mode(mode), name=f"mode {mode}")

    async def takeoff(
        self, altitude: float = 10.0, *, wait: bool = True, timeout: float | None = None
    ) -> Results[None]:
        """Let all take off; see `Vehicle.takeoff`."""
        return await self.each(
            lambda vehicle: vehicle.takeoff(altitude, wait=wait, timeout=timeout), name="takeoff"
        )

    async def land(self, *, wait: bool = True, timeout: float | None = None) -> Results[None]:
        """Let all land; see `Vehicle.land`."""
        return await self.each(lambda vehicle: vehicle.land(wait=wait, timeout=timeout), name="landing")

    async def rtl(self, *, wait: bool = True, timeout: float | None = None) -> Results[None]:
        """Let all return home; see `Vehicle.rtl`."""
        return await self.each(lambda vehicle: vehicle.rtl(wait=wait, timeout=timeout), name="return home")

    async def hold(self) -> Results[None]:
        """Let all stay where they are; see `Vehicle.hold`."""
        return await self.each(lambda vehicle: vehicle.hold(), name="hold")

    async def set_speed(self, speed: float) -> Results[None]:
        """Let all fly with so many m/s; see `Vehicle.set_speed`."""
        return await self.each(lambda vehicle: vehicle.set_speed(speed), name="speed")

    async def reboot(self, *, wait: bool = True) -> Results[None]:
        """Reboot all autopilots; see `Vehicle.reboot`."""
        return await self.each(lambda vehicle: vehicle.reboot(wait=wait), name="reboot")

    # As a collection

    @property
    def systems(self) -> tuple[int, ...]:
        """The system ids."""
        return tuple(vehicle.system for vehicle in self)

    def __contains__(self, vehicle: object) -> bool:
        return vehicle in self._vehicles

    def __iter__(self) -> Iterator[Vehicle]:
        return iter(self._vehicles)

    def __len__(self) -> int:
        return len(self._vehicles)

    def __repr__(self) -> str:
        return f"<Group of {', '.join(map(str, self.systems)) or 'nobody'}>"


async def _outcome(
    work: Callable[[Vehicle], Awaitable[Result]],
    vehicle: Vehicle,
    what: str,
    turn: AbstractAsyncContextManager[object],
) -> Result | Exception:
    """What one vehicle came to; if the group itself was cancelled, the group says so."""
    async with turn:
        try:
            return await work(vehicle)
        except Exception as error:  # noqa: BLE001 (whatever it is, it is told, and the others go on)
            return error
        except asyncio.CancelledError:
            return RemoteCancelled(what, str(vehicle.address), answer="cancelled by what was to do it")
