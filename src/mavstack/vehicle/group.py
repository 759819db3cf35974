"""Groups of vehicles: one operation on all of them, with the outcome of each.

    fleet = await connection.wait_for_vehicles(50)
    results = await fleet.arm()
    for vehicle, error in results.errors.items(): ...        # why it failed
    results = await fleet.each(lambda vehicle: vehicle.params.set("RTL_ALT", 3000), max_concurrency=10)
    results.check()                                          # GroupError if any failed

The operation runs on all vehicles at the same time, or on `max_concurrency` of them, and a failure on one
stops no other. `Results` holds the outcome of each, its result or its error, even if the error is a defect of
the function that was passed. Cancelling the task cancels the operation on every vehicle, and waits until it
has ended on each.
"""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Mapping
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from mavstack.errors import GroupError, InvalidArgumentError, RemoteCancelled
from mavstack.node.api_object import ApiObject, ReadOnly
from mavstack.vehicle import group_flights

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Iterator
    from contextlib import AbstractAsyncContextManager

    from mavstack.vehicle.vehicle import Vehicle

Result = TypeVar("Result")


class Results(ApiObject, Mapping["Vehicle", "Result | Exception"], Generic[Result]):
    """The outcome of an operation for each vehicle of a group: its result, or the error that it raised."""

    def __init__(self, outcomes: Mapping[Vehicle, Result | Exception], name: str = "work") -> None:
        self._outcomes = dict(outcomes)
        self._name = name

    @property
    def ok(self) -> bool:
        """True if the operation succeeded on all vehicles."""
        return not self.errors

    @property
    def succeeded(self) -> dict[Vehicle, Result]:
        """The results of the vehicles on which the operation succeeded."""
        return {
            vehicle: outcome
            for vehicle, outcome in self._outcomes.items()
            if not isinstance(outcome, Exception)
        }

    @property
    def errors(self) -> dict[Vehicle, Exception]:
        """The errors of the vehicles on which the operation failed."""
        return {
            vehicle: outcome for vehicle, outcome in self._outcomes.items() if isinstance(outcome, Exception)
        }

    @property
    def failed(self) -> Group:
        """The group of the vehicles on which the operation failed, to try again."""
        return Group(self.errors)

    def check(self) -> dict[Vehicle, Result]:
        """Return the results of all vehicles.

        Returns:
            The result of each vehicle.

        Raises:
            GroupError: The operation failed on a vehicle; the error holds the error of each.
        """
        errors = self.errors
        if not errors:
            return self.succeeded
        by_system = {vehicle.system: error for vehicle, error in errors.items()}
        defect = next((error for error in errors.values() if not GroupError.expects(error)), None)
        raise GroupError(self._name, by_system, len(self)) from defect

    def __getitem__(self, vehicle: Vehicle) -> Result | Exception:
        return self._outcomes[vehicle]

    def __iter__(self) -> Iterator[Vehicle]:
        return iter(self._outcomes)

    def __len__(self) -> int:
        return len(self._outcomes)

    def __repr__(self) -> str:
        errors = {vehicle.system: error for vehicle, error in self.errors.items()}
        details = f"; errors: {errors}" if errors else ""
        return f"<Results of {self._name}: {len(self) - len(errors)} of {len(self)} succeeded{details}>"


class Group(ReadOnly, Collection["Vehicle"]):
    """Several vehicles, each once, in the order in which they were given.

    The actions run the method of `Vehicle` with the same name on all vehicles. They raise no error of a
    vehicle: the returned `Results` hold them, and `Results.check` raises `GroupError`. The flights as one
    swarm (`formation`, `move`, `goto`, `follow`) fly all vehicles or none, and raise errors.
    """

    def __init__(self, vehicles: Iterable[Vehicle]) -> None:
        self._vehicles = dict.fromkeys(vehicles)

    async def each(
        self,
        work: Callable[[Vehicle], Awaitable[Result]],
        *,
        max_concurrency: int | None = None,
        name: str = "work",
    ) -> Results[Result]:
        """Run an async function for every vehicle.

        Args:
            work: The function; it gets the vehicle.
            max_concurrency: The number of vehicles for which it runs at the same time; None: all.
            name: The name of the operation in errors, a gerund.

        Returns:
            The result or the error of each vehicle.

        Raises:
            InvalidArgumentError: `max_concurrency` is less than 1.
        """
        if max_concurrency is not None and max_concurrency < 1:
            raise InvalidArgumentError(f"max_concurrency must be at least 1, got {max_concurrency}")
        slots = None if max_concurrency is None else asyncio.Semaphore(max_concurrency)
        async with asyncio.TaskGroup() as tasks:
            running = {
                vehicle: tasks.create_task(_outcome(work, vehicle, name, slots or nullcontext()))
                for vehicle in self
            }
        return Results({vehicle: task.result() for vehicle, task in running.items()}, name)

    # Actions of all vehicles

    async def arm(
        self,
        *,
        force: bool = False,
        allow_flight: bool = False,
        keep_mode: bool = False,
        timeout: float | None = None,
    ) -> Results[None]:
        """Arm all vehicles.

        Args:
            force: Skip the firmware's checks, as far as it allows that.
            allow_flight: Arm also in modes in which a vehicle starts to fly or drive at once.
            keep_mode: Refuse instead of leaving a mode in which a firmware does not arm.
            timeout: Seconds for each vehicle; None: until retries are exhausted or progress stalls.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.arm`.
        """
        options: dict[str, Any] = {"force": force, "allow_flight": allow_flight, "keep_mode": keep_mode}
        return await self.each(lambda vehicle: vehicle.arm(**options, timeout=timeout), name="arming")

    async def disarm(self, *, force: bool = False, timeout: float | None = None) -> Results[None]:
        """Disarm all vehicles.

        Args:
            force: Stop the motors even in the air.
            timeout: Seconds for each vehicle; None: until retries are exhausted or progress stalls.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.disarm`.
        """
        return await self.each(lambda vehicle: vehicle.disarm(force=force, timeout=timeout), name="disarming")

    async def set_mode(self, mode: str | int, *, timeout: float | None = None) -> Results[None]:
        """Set the flight mode of all vehicles; each firmware has its own modes.

        Args:
            mode: The name of the mode, or its custom mode number.
            timeout: Seconds for each vehicle; None: until retries are exhausted.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.set_mode`.
        """
        return await self.each(
            lambda vehicle: vehicle.set_mode(mode, timeout=timeout), name=f"setting mode {mode}"
        )

    async def takeoff(
        self, altitude: float = 10.0, *, wait: bool = True, timeout: float | None = None
    ) -> Results[None]:
        """Let all vehicles take off.

        Args:
            altitude: Metres above home.
            wait: Wait until each vehicle has reached the altitude.
            timeout: Seconds for each vehicle; None sets no overall limit.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.takeoff`.
        """
        return await self.each(
            lambda vehicle: vehicle.takeoff(altitude, wait=wait, timeout=timeout), name="takeoff"
        )

    async def land(self, *, wait: bool = True, timeout: float | None = None) -> Results[None]:
        """Let all vehicles land.

        Args:
            wait: Wait until each vehicle has landed.
            timeout: Seconds for each vehicle; None sets no overall limit.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.land`.
        """
        return await self.each(lambda vehicle: vehicle.land(wait=wait, timeout=timeout), name="landing")

    async def rtl(self, *, wait: bool = True, timeout: float | None = None) -> Results[None]:
        """Let all vehicles return to home.

        Args:
            wait: Wait until each vehicle has landed, or has arrived where it does not land.
            timeout: Seconds for each vehicle; None sets no overall limit.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.rtl`.
        """
        return await self.each(
            lambda vehicle: vehicle.rtl(wait=wait, timeout=timeout), name="return to launch"
        )

    async def hold(self, *, timeout: float | None = None) -> Results[None]:
        """Let all vehicles hold their positions.

        Args:
            timeout: Seconds for each vehicle; None: until retries are exhausted.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.hold`.
        """
        return await self.each(lambda vehicle: vehicle.hold(timeout=timeout), name="holding the position")

    async def set_speed(self, speed: float, *, timeout: float | None = None) -> Results[None]:
        """Set the ground speed of all vehicles.

        Args:
            speed: Metres per second.
            timeout: Seconds for each vehicle; None: until retries are exhausted.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.set_speed`.
        """
        return await self.each(
            lambda vehicle: vehicle.set_speed(speed, timeout=timeout), name="setting the speed"
        )

    async def reboot(self, *, wait: bool = True, timeout: float | None = None) -> Results[None]:
        """Reboot all autopilots.

        Args:
            wait: Wait until each autopilot is back.
            timeout: Seconds for each vehicle; None: until retries are exhausted, or it stays away.

        Returns:
            The outcome of each vehicle; its errors are those of `Vehicle.reboot`.
        """
        return await self.each(lambda vehicle: vehicle.reboot(wait=wait, timeout=timeout), name="rebooting")

    # Flights as one swarm that keeps a distance between its vehicles

    formation = group_flights.formation
    move = group_flights.move
    goto = group_flights.goto
    follow = group_flights.follow
    search = group_flights.search
    land_all = group_flights.land_all

    # Methods of a collection

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
        return f"<Group of {', '.join(map(str, self.systems)) or 'no vehicles'}>"


async def _outcome(
    work: Callable[[Vehicle], Awaitable[Result]],
    vehicle: Vehicle,
    name: str,
    slot: AbstractAsyncContextManager[object],
) -> Result | Exception:
    """Return the result or the error of one vehicle; the group itself is cancelled by `TaskGroup`."""
    async with slot:
        try:
            return await work(vehicle)
        except Exception as error:  # noqa: BLE001 (every error is an outcome, and the others go on)
            return error
        except asyncio.CancelledError:
            answer = "the function was cancelled"
            return RemoteCancelled(f"{name} on", str(vehicle.address), answer=answer)
