"""All clients, in the order of the table."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from benchmarks.measure import OURS

from .model import Work
from .program import Program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .model import Transfer
    from .vehicles import Vehicle

# name, module of the program, required distribution, and the works with their names in the program
PEERS: tuple[tuple[str, str, str, tuple[tuple[Work, str], ...]], ...] = (
    (
        OURS,
        "ours",
        "mavstack",
        (
            (Work.PARAMETERS, "parameters"),
            (Work.FILE, "file"),
            (Work.MISSION_UP, "mission-up"),
            (Work.MISSION_DOWN, "mission-down"),
        ),
    ),
    (f"{OURS}, listed", "ours", "mavstack", ((Work.PARAMETERS, "listed"),)),
    (
        "MAVSDK",
        "peer_mavsdk",
        "mavsdk",
        (
            (Work.PARAMETERS, "parameters"),
            (Work.FILE, "file"),
            (Work.MISSION_UP, "mission-up"),
            (Work.MISSION_DOWN, "mission-down"),
        ),
    ),
    ("MAVSDK, bursts", "peer_mavsdk", "mavsdk", ((Work.FILE, "file-burst"),)),
    (
        "pymavlink script",
        "peer_pymavlink",
        "pymavlink",
        (
            (Work.PARAMETERS, "parameters"),
            (Work.MISSION_UP, "mission-up"),
            (Work.MISSION_DOWN, "mission-down"),
        ),
    ),
    ("mavftp", "peer_pymavlink", "pymavlink", ((Work.FILE, "file"),)),
    ("mavftp, packed", "peer_pymavlink", "pymavlink", ((Work.PARAMETERS, "packed"),)),
    (
        "MAVProxy",
        "peer_mavproxy",
        "MAVProxy",
        (
            (Work.PARAMETERS, "parameters"),
            (Work.MISSION_UP, "mission-up"),
            (Work.MISSION_DOWN, "mission-down"),
        ),
    ),
    ("MAVProxy, packed", "peer_mavproxy", "MAVProxy", ((Work.PARAMETERS, "packed"),)),
)
PACKED = "packed"


def transfers(work: Work, vehicle: Vehicle) -> Iterator[Transfer]:
    """Yield the installed clients that can do a piece of work with a vehicle."""
    for name, module, distribution, works in PEERS:
        if find_spec(distribution) is None:
            continue
        for supported, operation in works:
            if supported == work and (vehicle.packed or operation != PACKED):
                yield Program(name, work, module, operation)
