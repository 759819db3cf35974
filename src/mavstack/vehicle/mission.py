"""The mission of a vehicle: put on it, flown, followed.

    await vehicle.mission.upload(items)
    await vehicle.mission.fly()                    # to its end
    async for item in vehicle.mission.reached_items(): …   # or each item that it reaches

A mission is over when the vehicle says so (MISSION_CURRENT's state), or, with older firmwares that do not,
when its last item was reached or the vehicle disarmed in it, as at the end of a landing. A vehicle that
disarms before that was interrupted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.node.plans import Plans
from mavstack.services.mission import ItemReached, MissionProgress, PlanType
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.actions.flying import LandingDetector, SustainedCondition
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.node.subscription import Subscription
    from mavstack.services.mission import MissionItem, Plan
    from mavstack.vehicle.vehicle import Vehicle

_STATE: Final = common.MissionState
_LANDING_MODES: Final = frozenset({"rtl", "land", "qrtl", "qland", "auto_rtl"})
#: A long leg, or a wait that the mission itself asks for: nothing is reached for that long.
PATIENCE: Final = 1800.0
#: PX4 says that a mission is over, then enters the mode that its last item asks for, and leaves that one
#: before its heartbeat says that it was disarmed.
AFTERWARDS: Final = 2.5

#: What drives or dives has come to rest when it was slower than this, in m/s, for so many seconds.
SLOW: Final = 0.3
STANDS: Final = 4.0


class VehiclePlan:
    """A plan of a vehicle, with its reasons when it refuses."""

    def __init__(self, vehicle: Vehicle, plan_type: int) -> None:
        self._vehicle = vehicle
        self._plans = Plans(vehicle.component, plan_type)
        #: How many items it holds, as far as they were sent or fetched.
        self.count: int | None = None

    async def upload(
        self,
        items: Plan | Iterable[MissionItem],
        *,
        timeout: float | None = None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Plan:
        """Give the vehicle a plan in the place of its own; it holds either the old or the whole new one."""
        asked = self._plans.upload(items, timeout=timeout, progress=progress)
        plan = await with_status_texts(self._vehicle, asked)
        self.count = len(plan)
        return plan

    async def download(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> Plan:
        """Get the plan that the vehicle holds."""
        asked = self._plans.download(timeout=timeout, progress=progress)
        plan = await with_status_texts(self._vehicle, asked)
        self.count = len(plan)
        return plan

    async def clear(self, *, timeout: float | None = None) -> None:
        """Let the vehicle forget the plan."""
        await with_status_texts(self._vehicle, self._plans.clear(timeout=timeout))


class Mission(VehiclePlan):
    """What a vehicle is to fly."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle, PlanType.MISSION)

    @property
    def progress(self) -> MissionProgress | None:
        """Where the vehicle said last that it is in it."""
        return self._plans.progress

    def items(self) -> Subscription[ItemReached]:
        """Each item that is reached from now on."""
        return self._vehicle.connection.events(ItemReached, of=self._vehicle.component.mission_client)

    async def set_current(self, seq: int, *, restart: bool = False) -> None:
        """Let it go on at an item; `restart` lets it begin anew, its jump counters too."""
        await with_status_texts(self._vehicle, self._plans.set_current(seq, restart=restart))

    async def start(self) -> None:
        """Fly it, from the start or from where it was paused; the vehicle has to be armed, or to arm next."""
        await with_status_texts(self._vehicle, self._vehicle.firmware.start_mission())

    async def pause(self) -> None:
        """Wait where the vehicle is; `start` goes on."""
        await with_status_texts(self._vehicle, self._vehicle.firmware.pause_mission())

    async def fly(self, *, timeout: float | None = None) -> None:
        """Arm if need be, start, and wait for the end; a mission that lands ends with the motors."""
        vehicle = self._vehicle
        ending = MissionCompletion(vehicle)
        if self.count is None and not (self.progress and self.progress.total):  # as older ones do not tell it
            await self.download()
        async with ActionMonitor(vehicle) as watch, self.items() as reached:
            if not vehicle.armed:
                await with_status_texts(vehicle, vehicle.firmware.become_armable())
                await vehicle.arm()
            await self.start()
            aim = ActionGoal(
                "the mission",
                lambda: ending.come([item.seq for item in reached.drain()]),
                ending.left,
                unit="items",
                modes=ending,
                armed=True,
                limit=timeout,
                patience=PATIENCE,
            )
            await watch.until(aim)


class MissionCompletion:
    """Whether a mission is over, and what it ended with has been done.

    A mode is in it if the mission goes on in it: the one in which a vehicle waits when all is done only at
    the end, since before that it is a pause.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._modes = vehicle.firmware.modes_of("mission")
        self._modes_at_end = vehicle.firmware.modes_of("end of mission") or frozenset()
        self._landing = LandingDetector(vehicle)
        self._standing = SustainedCondition(vehicle, STANDS)
        self._running = False
        self._over_at: float | None = None
        self._furthest = 0
        self._reached: set[int] = set()

    def __contains__(self, mode: object) -> bool:
        progress = self._vehicle.mission.progress
        at_end = self._over_at is not None or (progress is not None and progress.seq >= self._last(progress))
        return self._modes is None or mode in self._modes or (at_end and mode in self._modes_at_end)

    def left(self) -> float | None:
        """How many items are left."""
        progress = self._vehicle.mission.progress
        return None if progress is None else float(progress.total - progress.seq)

    def come(self, reached: list[int]) -> bool:
        """Whether it has ended, now that these items were reached, too."""
        self._reached.update(reached)
        progress = self._vehicle.mission.progress
        if progress is None:
            return False
        self._running = self._running or progress.state == _STATE.ACTIVE or bool(self._reached)
        if self._running:
            last = self._last(progress)
            left_it = progress.seq >= last and self._lands  # a return that is a mode of its own
            told = progress.state != _STATE.UNKNOWN
            finished = progress.state == _STATE.COMPLETE if told else last in self._reached
            done = finished or left_it
            # ArduPilot begins anew when it is disarmed, and may say that first.
            self._furthest = max(self._furthest, progress.seq)
            if done or (self._vehicle.armed is False and self._furthest >= last):
                self._over_at = self._over_at or self._vehicle.connection.now()
        return self._over_at is not None and self._has_settled(self._over_at)

    def _has_settled(self, over_at: float) -> bool:
        """Whether it has landed or stands, or does nothing that lands and did not lately."""
        if self._stands() if not self._vehicle.vehicle_type.flies else self._landing.ended():
            return True
        now = self._vehicle.connection.now()
        if self._lands:
            self._over_at = now
            return False
        return now >= over_at + AFTERWARDS

    def _stands(self) -> bool:
        velocity = self._vehicle.velocity
        slow = velocity is not None and velocity.ground_speed < SLOW
        return self._standing.goes_on(slow)

    def _last(self, progress: MissionProgress) -> int:
        """The number of the last item: home, where it is one, does not count among them."""
        if not progress.total:
            return (self._vehicle.mission.count or 0) - 1
        first = 1 if self._vehicle.component.mission_client.home_first else 0
        return progress.total - 1 + first

    @property
    def _lands(self) -> bool:
        """Whether its last item was a landing or a return, which goes on in a mode of its own.

        A plane that returned circles there for ever.
        """
        mode = (self._vehicle.mode or "").lower()
        circles = mode == "rtl" and self._vehicle.vehicle_type is VehicleType.PLANE
        return mode in _LANDING_MODES and not circles
