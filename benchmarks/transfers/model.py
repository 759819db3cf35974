"""What a transfer is: the work, where it is done, what came of it, and the shape of every client's driver."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from pathlib import Path

PLAN_LENGTH = 200


class Work(StrEnum):
    """The pieces of work that are timed."""

    PARAMETERS = "parameters"
    FILE = "file"
    MISSION_UP = "mission-up"
    MISSION_DOWN = "mission-down"


@dataclass(frozen=True, slots=True)
class Item:
    """A mission item, as far as it is compared."""

    frame: int
    command: int
    x: int
    y: int
    z: float


@dataclass(frozen=True, slots=True)
class Endpoint:
    """Where a ground station speaks to, and what it needs to know to do its work there."""

    port: int
    folder: Path  # for what is downloaded
    limit: float  # seconds until a transfer counts as never ending
    remote_file: str = ""
    plan: tuple[Item, ...] = ()


@dataclass(frozen=True, slots=True)
class Result:
    """What one transfer says of itself; only what the work was about is filled in."""

    seconds: float | None  # None: did not end, or said that it failed
    problem: str = ""
    parameters: dict[str, float] = field(default_factory=dict)
    plan: tuple[Item, ...] = ()
    file: bytes = b""


class Transfer(Protocol):
    """One client doing one piece of work."""

    @property
    def name(self) -> str:
        """Who does it, and how."""

    @property
    def work(self) -> Work:
        """What it does."""

    def run(self, endpoint: Endpoint) -> Result:
        """Do it once; the clock runs from the first request, with the vehicle already heard, to the end."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """One turn of one client, judged: the seconds it took, or why it does not count."""

    seconds: float | None
    problem: str = ""

    @property
    def finished(self) -> bool:
        """Whether everything arrived, and rightly."""
        return self.seconds is not None and not self.problem


def sample_plan(length: int = PLAN_LENGTH) -> tuple[Item, ...]:
    """Waypoints 30 m apart in rows of twenty, near the simulators' home."""
    return tuple(
        Item(
            frame=3,  # MAV_FRAME_GLOBAL_RELATIVE_ALT, which an old ArduPilot takes too
            command=16,  # MAV_CMD_NAV_WAYPOINT
            x=-353632610 + 2700 * (place % 20),
            y=1491652300 + 3300 * (place // 20),
            z=50.0 + place % 7,
        )
        for place in range(length)
    )
