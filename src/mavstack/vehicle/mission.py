"""The plans of a vehicle: its mission, flown and followed, its fence and its rally points.

    await vehicle.mission.upload(items)
    await vehicle.mission.fly()                              # to its end
    async for item in vehicle.mission.reached_items(): ...   # or each item that it reaches

A mission has ended when the vehicle reports it (`mission_state` of MISSION_CURRENT), or, with older firmwares
that do not, when its last item was reached or the vehicle was disarmed in it, as at the end of a landing. A
vehicle that is disarmed before that was interrupted.
"""

from __future__ import annotations

import logging
import warnings
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MissionWarning
from mavstack.geodesy import distance
from mavstack.node.api_object import ReadOnly
from mavstack.services.arguments import check_number
from mavstack.services.mission import PlanType
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.actions import arming
from mavstack.vehicle.actions.arming import enter_waiting_mode
from mavstack.vehicle.actions.preconditions import check_preconditions, refusal
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.firmware.changes import Changes, undone_on_failure
from mavstack.vehicle.mission_completion import MissionCompletion
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mavstack.node.plans import Plans
    from mavstack.node.subscription import Subscription
    from mavstack.services.mission import ItemReached, MissionItem, MissionProgress, Plan
    from mavstack.swarm.search.surveys import Survey
    from mavstack.vehicle.vehicle import Vehicle

#: The longest time without a reached item, in seconds: a leg may be long, and the mission may contain a wait.
STALL_TIMEOUT: Final = 1800.0
#: The rate of MISSION_CURRENT while a mission is flown, in hertz.
PROGRESS_RATE: Final = 1.0
#: A mission whose first item is farther from the vehicle than this, in metres, gets a warning.
MAX_FIRST_DISTANCE: Final = 10_000.0
#: The total in MISSION_CURRENT of a vehicle without a mission.
NO_MISSION: Final = 0xFFFF
_CMD: Final = common.MavCmd
_LANDINGS: Final = frozenset(
    {_CMD.NAV_LAND, _CMD.NAV_VTOL_LAND, _CMD.NAV_RETURN_TO_LAUNCH, _CMD.NAV_LAND_LOCAL}
)

logger = logging.getLogger("mavstack.vehicle")


class VehiclePlan(ReadOnly):
    """A plan of a vehicle: `fence` and `rally`; errors carry the vehicle's status texts."""

    def __init__(self, vehicle: Vehicle, plan_type: int) -> None:
        self._vehicle = vehicle
        component = vehicle.component
        plans: dict[int, Plans] = {
            PlanType.MISSION: component.mission,
            PlanType.FENCE: component.fence,
            PlanType.RALLY: component.rally,
        }
        self._plans = plans[plan_type]
        self._call = {PlanType.FENCE: "fence", PlanType.RALLY: "rally"}.get(PlanType(plan_type), "mission")
        self._plan: Plan | None = None

    @property
    def count(self) -> int | None:
        """The number of items, as of the last upload or download; None before."""
        return None if self._plan is None else len(self._plan)

    async def upload(
        self,
        items: Plan | Iterable[MissionItem],
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Plan:
        """Replace the vehicle's plan atomically: it holds either the old or the whole new plan.

        Args:
            items: A plan or its items.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the number of items sent and the number of all items.

        Returns:
            The plan, with the id that the vehicle gave it.

        Raises:
            InvalidTypeError: An item is not a `MissionItem`.
            MissionDenied: The vehicle refused the plan.
            MissionTimeout: The vehicle did not answer, or the transfer stalled.
        """
        self._check_supported()
        plan = await with_status_texts(
            self._vehicle, self._plans.upload(items, timeout=timeout, progress=progress)
        )
        self._plan = plan
        return plan

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Plan:
        """Download the vehicle's plan.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the number of items received and the number of all items.

        Returns:
            The plan.

        Raises:
            MissionDenied: The vehicle refused the transfer.
            MissionTimeout: The vehicle did not answer, or the transfer stalled.
        """
        self._check_supported()
        plan = await with_status_texts(
            self._vehicle, self._plans.download(timeout=timeout, progress=progress)
        )
        self._plan = plan
        return plan

    async def clear(self, *, timeout: float | None = None) -> None:
        """Remove the vehicle's plan.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            MissionDenied: The vehicle refused.
            MissionTimeout: The vehicle did not answer.
        """
        self._check_supported()
        await with_status_texts(self._vehicle, self._plans.clear(timeout=timeout))

    def _check_supported(self) -> None:
        firmware_of(self._vehicle).check_supported(self._call)


class Mission(VehiclePlan, ReadOnly):
    """The mission of a vehicle; `vehicle.mission`."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle, PlanType.MISSION)

    async def upload(
        self,
        items: Plan | Iterable[MissionItem],
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Plan:
        """Replace the vehicle's mission atomically: it holds either the old or the whole new mission.

        A mission that begins far away is uploaded, with a `MissionWarning`.

        Args:
            items: A plan or its items.
            timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.
            progress: Called with the number of items sent and the number of all items.

        Returns:
            The plan, with the id that the vehicle gave it.

        Raises:
            InvalidTypeError: An item is not a `MissionItem`.
            MissionDenied: The vehicle refused the plan.
            MissionTimeout: The vehicle did not answer, or the transfer stalled.
        """
        plan = await super().upload(items, timeout=timeout, progress=progress)
        if text := self._distance_warning(plan):
            logger.warning("%s", text)
            warnings.warn(text, MissionWarning, stacklevel=2)
        return plan

    def plan_survey(
        self,
        outline: Sequence[tuple[float, float]],
        survey: Survey | None = None,
        *,
        obstacles: Sequence[Sequence[tuple[float, float]]] = (),
    ) -> list[MissionItem]:
        """Return a mission that covers an area, from where the vehicle is; nothing is sent.

        Args:
            outline: Corners of the area, latitude and longitude in degrees.
            survey: Spacing or camera, height and speed; None: 20 m between tracks, 30 m above home.
            obstacles: Outlines of regions that are left out.

        Returns:
            The items, for `upload`.

        Raises:
            InvalidArgumentError: The outline or a number is not possible.
        """
        from mavstack.swarm.search.surveys import Survey, frame_of, plan_area
        from mavstack.vehicle.group_flights import searcher_of

        options = survey or Survey()
        searcher = searcher_of(self._vehicle, frame_of(outline), options.mission.speed)
        return list(plan_area(outline, [searcher], options, obstacles=obstacles).shares[0].items)

    @property
    def progress(self) -> MissionProgress | None:
        """The last progress that the vehicle reported (MISSION_CURRENT); None before the first report."""
        return self._plans.progress

    @property
    def last_seq(self) -> int:
        """The sequence number of the last item, as far as it is known; -1 if it is not."""
        progress, count, home = self.progress, self.count or 0, int(self._plans.home_first)
        if progress is None or not progress.total or count - home <= progress.total <= count:
            # Some versions of ArduPilot count the home item in the total, others do not.
            return count - 1
        return progress.total - 1 + home

    @property
    def landing_seq(self) -> int:
        """The sequence number of the landing or return at the end of the mission; else `last_seq`."""
        last = self.last_seq
        if self._plan is None or last != len(self._plan) - 1:
            return last
        flown = [seq for seq, item in enumerate(self._plan.items) if item.command < _CMD.NAV_LAST]
        return flown[-1] if flown and self._plan.items[flown[-1]].command in _LANDINGS else last

    def reached_items(self) -> Subscription[ItemReached]:
        """Return an async iterator of the items that the vehicle reaches from now on.

        Returns:
            A subscription of `ItemReached` events; close it, or use it as an async context manager.
        """
        return self._plans.reached_items()

    def _distance_warning(self, plan: Plan) -> str | None:
        position = self._vehicle.position
        first = 1 if self._plans.home_first else 0
        places = [
            (seq, item.location) for seq, item in enumerate(plan.items) if seq >= first and item.location
        ]
        if position is None or not places:
            return None
        seq, (latitude, longitude) = places[0]
        away = distance(position.latitude, position.longitude, latitude, longitude)
        if away <= MAX_FIRST_DISTANCE:
            return None
        return (
            f"the mission of {self._vehicle.address} begins {away / 1000:,.0f} km from the vehicle: "
            f"item {seq} is at {latitude:.6f}, {longitude:.6f}"
        )

    async def set_current(self, seq: int, *, restart: bool = False, timeout: float | None = None) -> None:
        """Set the item that the vehicle flies to next.

        Args:
            seq: The sequence number of the item.
            restart: Start the mission again, with its jump counters reset.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: The sequence number is not a number.
            CommandDenied: The vehicle refused the item.
            CommandTimeout: The vehicle did not answer, and `restart` is set.
            MissionDenied: The vehicle refused MISSION_SET_CURRENT.
            MissionTimeout: The vehicle did not answer.
        """
        check_number("seq", seq)
        self._check_supported()
        check_preconditions(self._vehicle, "mission current", "setting the mission item of")
        await with_status_texts(self._vehicle, self._plans.set_current(seq, restart=restart, timeout=timeout))

    async def start(self, *, arm: bool = False, timeout: float | None = None) -> None:
        """Fly the mission, from its start or from where it was paused.

        Args:
            arm: Arm a disarmed vehicle first, as `Vehicle.arm` does; it leaves a mode in which it does not
                arm or would start by itself, and is disarmed again if it refuses the mission.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            ActionRefused: The vehicle is not armed, and `arm` is False, or it has no mission; nothing but
                reads was sent.
            CommandDenied: The vehicle refused; it is as it was before.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted its mission mode and did not enter it.
            ActionTimeout: The call did not end within `timeout`.
        """
        self._check_supported()
        vehicle, operation = self._vehicle, "starting the mission of"
        check_preconditions(vehicle, "mission fly" if arm else "mission start", operation)
        async with deadline(timeout, operation, vehicle.address):
            await self._refuse_if_empty(operation)
            await self._start(arm=arm)

    async def _refuse_if_empty(self, operation: str) -> None:
        """Raise if there is nothing to fly: ArduPlane would return to home, armed on the ground too."""
        empty = self._is_empty
        if empty or (empty is None and self._plans.home_first):
            await self.download()  # another program may have uploaded a mission meanwhile
            if self._is_empty:
                reason = "it has no mission; upload one first"
                raise refusal(self._vehicle, operation, reason)

    @property
    def _is_empty(self) -> bool | None:
        """True if the vehicle has no item that it can fly; None if that is not known."""
        if self._plan is not None:
            return len(self._plan) <= int(self._plans.home_first)
        progress = self.progress
        if progress is None or not progress.total:
            return None
        return progress.state == common.MissionState.NO_MISSION or progress.total == NO_MISSION

    async def _start(self, *, arm: bool) -> None:
        """Arm if needed, and enter the mission; reverse both if a step fails."""
        vehicle = self._vehicle
        changes = Changes(vehicle)
        async with undone_on_failure(changes):
            if arm and vehicle.armed is not True:
                if firmware_of(vehicle).starts_by_itself(vehicle.mode):
                    await with_status_texts(vehicle, enter_waiting_mode(vehicle, changes))
                await arming.arm_as_step(vehicle, changes)
            await with_status_texts(vehicle, firmware_of(vehicle, changes).start_mission())

    async def pause(self, *, timeout: float | None = None) -> None:
        """Hold the present position; `start` resumes the mission.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            ActionRefused: The vehicle is not armed; nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted the mode and did not enter it.
            ActionTimeout: The call did not end within `timeout`.
        """
        self._check_supported()
        operation = "pausing the mission of"
        check_preconditions(self._vehicle, "mission pause", operation)
        async with deadline(timeout, operation, self._vehicle.address):
            await with_status_texts(self._vehicle, firmware_of(self._vehicle).pause_mission())

    async def fly(self, *, timeout: float | None = None) -> None:
        """Arm if the vehicle is disarmed, start the mission, and wait for its end.

        A mission that ends with a landing ends when the vehicle has landed.

        Args:
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            ActionRefused: It has no mission; nothing but reads was sent.
            CommandDenied: The vehicle refused to be armed, or to start the mission; it is as it was before.
            CommandTimeout: The vehicle did not answer.
            ModeTimeout: The vehicle accepted its mission mode and did not enter it.
            MissionDenied: The vehicle refused the download of its mission.
            MissionTimeout: The vehicle did not answer the request for its mission.
            ActionTimeout: The call did not end within `timeout`, or no item was reached for a long time.
            ActionInterrupted: The vehicle left the mission.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        self._check_supported()
        vehicle, operation = self._vehicle, "flying the mission of"
        check_preconditions(vehicle, "mission fly", operation)
        firmware = firmware_of(vehicle)
        completion = MissionCompletion(vehicle, firmware, self)
        async with ActionMonitor(vehicle, operation, timeout) as monitor:
            if self.count is None and (self._plans.home_first or not (self.progress and self.progress.total)):
                await self.download()  # MISSION_CURRENT of older firmwares does not report the last item
            await self._refuse_if_empty(operation)
            await vehicle.telemetry.ensure(common.MissionCurrent, PROGRESS_RATE)
            async with self.reached_items() as reached:
                await self._start(arm=True)
                goal = ActionGoal(
                    lambda: completion.update([item.seq for item in reached.drain()]),
                    completion.remaining,
                    unit="items",
                    modes=completion,
                    armed=True,
                    stall_timeout=STALL_TIMEOUT,
                )
                await monitor.wait_until_reached(goal)
