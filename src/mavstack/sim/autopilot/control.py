"""Interfaces of the autopilot's large parts: guided flight, the mission, the fence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem, Plan
    from mavstack.services.setpoints import Setpoint
    from mavstack.sim.autopilot.course import Course
    from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits
    from mavstack.sim.autopilot.fence_shapes import Fence
    from mavstack.sim.autopilot.maneuvers import Point


class RunningBehaviour(Protocol):
    """A behaviour in progress; see `Behaviour`."""

    taking_off: bool
    landing: bool
    takes_setpoints: bool

    def fly(self) -> Iterator[None]:
        """Run the behaviour, one `yield` per tick."""


class GuidedControl(Protocol):
    """Guided flight: the active guided command and the stream of setpoints."""

    command: RunningBehaviour | None

    @property
    def stream_alive(self) -> bool:
        """True while the newest setpoint is recent."""

    def clear(self) -> None:
        """Drop the active guided command."""

    def follow_stream(self) -> None:
        """Follow the latest setpoint of the stream."""

    def set(self, setpoint: Setpoint) -> bool:
        """Accept a setpoint; returns False if this vehicle cannot follow it."""

    def go_to(
        self,
        point: Point,
        *,
        speed: float | None = None,
        radius: float | None = None,
        yaw: float | None = None,
    ) -> None:
        """Go to a point and stay there."""

    def fly_velocity(
        self,
        north: float,
        east: float,
        down: float,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> None:
        """Fly with a velocity in m/s until it times out."""

    def orbit(
        self,
        centre: Point,
        radius: float,
        *,
        speed: float | None = None,
        yaw_behaviour: int = common.OrbitYawBehaviour.HOLD_FRONT_TO_CIRCLE_CENTER,
        turns: float | None = None,
    ) -> None:
        """Circle a point; a positive radius means clockwise."""

    def take_off(
        self, altitude: float | None = None, *, down: float | None = None, yaw: float | None = None
    ) -> None:
        """Take off and stay above the place of the start."""


class MissionControl(Protocol):
    """The mission of one vehicle, as its autopilot, its commands and telemetry use it."""

    course: Course
    #: The behaviour that the current item runs, such as a take-off.
    part: RunningBehaviour | None
    #: True if a VTOL was commanded to hover on its way.
    hovers: bool
    paused: bool
    #: The last point of the mission that was flown to: the start of the next line.
    origin: Point | None
    #: The item that is flown now, even if the plan was replaced meanwhile.
    flown: MissionItem | None

    @property
    def items(self) -> tuple[MissionItem, ...]:
        """The items of the mission."""

    @property
    def exists(self) -> bool:
        """True if there is an item to fly."""

    @property
    def first(self) -> int:
        """The sequence number of the first item that is flown."""

    @property
    def sequence(self) -> int:
        """The sequence number of the current item."""

    @property
    def state(self) -> int:
        """MISSION_STATE."""

    @property
    def flying(self) -> bool:
        """True while the mission is flown."""

    @property
    def now(self) -> float:
        """Mission time: the clock stops while the mission is paused."""

    def valid(self) -> bool:
        """Return whether there is a mission that can be flown."""

    def refusal(self) -> str | None:
        """Return why the mission mode cannot be entered now; None if it can."""

    def start(self, first: int = 0, last: int = 0) -> str | None:
        """Fly the mission from item `first` to item `last`; returns the reason for a refusal."""

    def pause(self) -> bool:
        """Hold the position; returns False if no mission is flown."""

    def resume(self) -> bool:
        """Continue after a pause; returns False if no mission is flown."""

    def reset(self) -> None:
        """Start from the first item at the next flight."""

    def restore(self, seq: int) -> None:
        """Make an item current again, if the replaced mission has one of that number."""

    def go_to_item(self, seq: int, *, reset: bool = False) -> bool:
        """Continue at an item; returns False if there is none."""

    def begin_at(self, seq: int) -> None:
        """Continue at an item, or end the mission if `seq` is past the last one."""

    def landing_start(self) -> int | None:
        """Return the nearest DO_LAND_START, None if the mission has none."""

    def check(self, kind: int, seq: int, item: MissionItem) -> int:
        """Validate one item of an upload: MAV_MISSION_RESULT."""

    def validate(self, plan: Plan, source: Address) -> int:
        """Validate a whole plan: MAV_MISSION_RESULT."""

    def fly(self) -> Iterator[None]:
        """Fly the mission; ends only by leaving the mode."""

    def leave(self, *modes: int, reason: str) -> Iterator[None]:
        """Enter another mode, or several in turn, and wait for the change."""

    def keep_course(self) -> None:
        """Apply changes of speed and heading to the current line."""


class FenceControl(Protocol):
    """The fence of one vehicle."""

    #: The limits that are broken now.
    breaches: Breach
    #: The number of breaches since boot, and the time of the last one in seconds since boot.
    count: int
    breached_at: float
    #: True or False if a command enabled or disabled the fence; None: the parameters decide.
    switched: bool | None
    #: True if a command disabled the minimum altitude.
    floor_off: bool

    @property
    def fence(self) -> Fence:
        """The shapes of the fence plan."""

    @property
    def limits(self) -> FenceLimits:
        """The limits in force."""

    @property
    def enabled(self) -> bool:
        """True if any limit is in force."""

    def switch(self, setting: int) -> bool:
        """Apply DO_FENCE_ENABLE's param 1; returns False for an unknown value."""

    def reset_switch(self) -> None:
        """Go by the parameters again."""

    def problems(self) -> Iterator[str]:
        """Yield why the vehicle may not be armed where it is."""

    def status(self) -> common.FenceStatus:
        """Return FENCE_STATUS."""

    def breach_distance(self) -> float:
        """Return how far the vehicle is beyond its limits, in metres."""
