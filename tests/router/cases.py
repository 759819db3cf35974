"""The semantics of routers as a table: where each packet goes, by the routing guide.

A step is a packet that a program sends on one link, and the links on which it arrives. Links are letters.
The steps of a case follow each other; each packet has a new sequence number, except the `copy` of the last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message

#: The implementations that run the cases.
PURE, ENGINE, NODE, MAVLINK_ROUTER = "pure", "engine", "node", "mavlink-router"
ALL = frozenset({PURE, ENGINE, NODE, MAVLINK_ROUTER})
#: Other implementations have no groups of our kind, and pass on what belongs to one link.
OURS = frozenset({PURE, ENGINE, NODE})

VEHICLE, CAMERA, OTHER, STATION = (1, 1), (1, 100), (2, 1), (255, 190)
HEARTBEAT = common.Heartbeat(type=common.MavType.QUADROTOR)
STATION_HEARTBEAT = common.Heartbeat(type=common.MavType.GCS)
#: A message id that no dialect has.
UNKNOWN = None


@dataclass(frozen=True)
class Step:
    """A packet of `source` on a link, and the links that it reaches."""

    link: str
    source: tuple[int, int]
    message: Message | None
    reaches: str
    copy: bool = False
    version: int = 2


@dataclass(frozen=True)
class Case:
    """Steps on links; `groups` names redundant links, `by` the implementations that can express the case."""

    name: str
    steps: tuple[Step, ...]
    groups: Mapping[str, str] | None = None
    by: frozenset[str] = ALL

    @property
    def links(self) -> str:
        """The links of the case, in order."""
        used = {letter for step in self.steps for letter in step.link + step.reaches}
        return "".join(sorted(used | {*"ABC"}))


def command(system: int, component: int = 0) -> Message:
    """Return a command for a target."""
    return common.CommandLong(target_system=system, target_component=component, command=400, param1=1)


CASES = (
    Case(
        "a packet without a target goes to all others",
        (Step("A", VEHICLE, HEARTBEAT, "BC"), Step("B", STATION, HEARTBEAT, "AC")),
    ),
    Case(
        "a target of 0 is no target",
        (Step("A", VEHICLE, HEARTBEAT, "BC"), Step("B", STATION, command(0), "AC")),
    ),
    Case(
        "a packet with a target goes where the target was heard",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("B", OTHER, HEARTBEAT, "AC"),
            Step("C", STATION, command(1, 1), "A"),
            Step("C", STATION, command(2, 1), "B"),
            Step("A", VEHICLE, command(255, 190), "C"),
        ),
    ),
    Case(
        "a packet for all components goes wherever the system was heard",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("B", CAMERA, HEARTBEAT, "AC"),
            Step("C", STATION, command(1, 0), "AB"),
            Step("C", STATION, command(1, 100), "B"),
        ),
    ),
    Case(
        "an unknown component of a known system: wherever the system was heard",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("C", STATION, command(1, 55), "A"),
        ),
        by=OURS,
    ),
    Case(
        "an unknown system: nowhere",
        (Step("A", VEHICLE, HEARTBEAT, "BC"), Step("C", STATION, command(9, 1), "")),
    ),
    Case(
        "never back to the link of the source, even if the target is there",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("A", CAMERA, HEARTBEAT, "BC"),
            Step("A", CAMERA, command(1, 1), ""),
        ),
    ),
    Case(
        "every packet teaches, not only heartbeats",
        (
            Step("A", VEHICLE, common.Attitude(roll=0.5), "BC"),
            Step("C", STATION, command(1, 1), "A"),
        ),
    ),
    Case(
        "system 0 is never learned",
        (Step("A", (0, 1), HEARTBEAT, "BC"), Step("C", STATION, command(0, 1), "AB")),
    ),
    Case(
        "component 0 teaches its system",
        (Step("A", (250, 0), HEARTBEAT, "BC"), Step("B", VEHICLE, command(250, 0), "A")),
    ),
    Case(
        "an unknown message goes to all others, unchanged",
        (Step("A", VEHICLE, HEARTBEAT, "BC"), Step("B", STATION, UNKNOWN, "AC")),
    ),
    Case(
        "MAVLink 1 is routed like MAVLink 2",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC", version=1),
            Step("C", STATION, command(1, 1), "A", version=1),
        ),
    ),
    Case(
        "RADIO_STATUS stays on its link and teaches nothing",
        (Step("A", (51, 68), common.RadioStatus(rssi=200), ""), Step("C", STATION, command(51, 68), "")),
        by=OURS,
    ),
    Case(
        "SETUP_SIGNING never leaves its link",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("C", STATION, common.SetupSigning(target_system=1, target_component=1), ""),
            Step("A", VEHICLE, common.SetupSigning(), ""),
        ),
        by=OURS,
    ),
    Case(
        "a packet that comes back is dropped and teaches nothing",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("B", VEHICLE, HEARTBEAT, "", copy=True),
            Step("C", STATION, command(1, 1), "A"),
        ),
        by=OURS,
    ),
    Case(
        "equal packets of one link are no copies",
        (Step("A", VEHICLE, HEARTBEAT, "BC"), Step("A", VEHICLE, HEARTBEAT, "BC", copy=True)),
    ),
    Case(
        "links of a group deliver once, and get nothing from each other",
        (
            Step("A", VEHICLE, HEARTBEAT, "CD"),
            Step("B", VEHICLE, HEARTBEAT, "CD"),
            Step("A", VEHICLE, HEARTBEAT, "", copy=True),
            Step("C", STATION, command(1, 1), "AB"),
            Step("B", VEHICLE, command(255, 190), "C"),
        ),
        groups={"A": "radio", "B": "radio"},
        by=OURS,
    ),
    Case(
        "two ground stations with one address",
        (
            Step("A", VEHICLE, HEARTBEAT, "BC"),
            Step("B", STATION, STATION_HEARTBEAT, "AC"),
            Step("C", STATION, STATION_HEARTBEAT, "AB"),
            Step("A", VEHICLE, command(255, 190), "BC"),
        ),
        by=OURS,
    ),
    Case(
        "a reboot clears the routes over the other links of its group",
        (
            Step("A", VEHICLE, common.SystemTime(time_boot_ms=90_000), "CD"),
            Step("B", VEHICLE, common.SystemTime(time_boot_ms=90_100), "CD"),
            Step("C", STATION, command(1, 1), "AB"),
            Step("B", VEHICLE, common.SystemTime(time_boot_ms=500), "CD"),
            Step("C", STATION, command(1, 1), "B"),
        ),
        groups={"A": "radio", "B": "radio"},
        by=OURS - {NODE},
    ),
    Case(
        "a reboot that another link claims moves no route while the vehicle is heard",
        (
            Step("A", VEHICLE, common.SystemTime(time_boot_ms=90_000), "BC"),
            Step("B", VEHICLE, common.SystemTime(time_boot_ms=500), "AC"),
            Step("C", STATION, command(1, 1), "A"),
        ),
        by=OURS,
    ),
)
