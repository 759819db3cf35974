"""The model of a transfer: the work, the endpoint, the result, and the interface of the clients."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from pathlib import Path

PLAN_LENGTH = 200


class Work(StrEnum):
    """The timed pieces of work."""

    PARAMETERS = "parameters"
    FILE = "file"
    MISSION_UP = "mission-up"
    MISSION_DOWN = "mission-down"


@dataclass(frozen=True, slots=True)
class Item:
    """The compared part of a mission item."""

    frame: int
    command: int
    x: int
    y: int
    z: float


@dataclass(frozen=True, slots=True)
class Endpoint:
    """The address of the relay, and the parameters of the work."""

    port: int
    folder: Path  # for downloaded files
    timeout: float  # seconds after which a transfer counts as failed
    remote_file: str = ""
    plan: tuple[Item, ...] = ()


@dataclass(frozen=True, slots=True)
class Result:
    """The result that a client reports; only the data of its work is set."""

    seconds: float | None  # None: timed out or failed
    problem: str = ""
    parameters: dict[str, float] = field(default_factory=dict)
    plan: tuple[Item, ...] = ()
    file: bytes = b""


class Transfer(Protocol):
    """One client with one piece of work."""

    @property
    def name(self) -> str:
        """Name of the client, and how it does the work."""

    @property
    def work(self) -> Work:
        """The work of the client."""

    def run(self, endpoint: Endpoint) -> Result:
        """Run the work once; the time counts from the first request, after the vehicle was found."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The validated result of one turn: the seconds, or why the turn does not count."""

    seconds: float | None
    problem: str = ""

    @property
    def finished(self) -> bool:
        """True if all data arrived and is right."""
        return self.seconds is not None and not self.problem


def sample_plan(length: int = PLAN_LENGTH) -> tuple[Item, ...]:
    """Return waypoints 30 m apart in rows of twenty, near the home of the simulators."""
    return tuple(
        Item(
            frame=3,  # MAV_FRAME_GLOBAL_RELATIVE_ALT, which old versions of ArduPilot accept too
            command=16,  # MAV_CMD_NAV_WAYPOINT
            x=-353632610 + 2700 * (index % 20),
            y=1491652300 + 3300 * (index // 20),
            z=50.0 + index % 7,
        )
        for index in range(length)
    )
