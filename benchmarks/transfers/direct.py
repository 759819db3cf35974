"""Transfers over loopback without a relay and without loss, by Mavstack and MAVSDK in turns.

`python -m benchmarks.transfers.direct [--turns 5] [--works mission-up …] [--json]`

Only the two programs are between the first request and the last answer, so a figure is the time of their
round trips. Each transfer has a vehicle of its own: a simulated PX4 with 1,500 parameters and full
telemetry, or for the file a node that serves 10 MB. The time counts from when the client found the vehicle.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import OURS

from . import report, validation, vehicles
from .clients import transfers
from .model import Endpoint, Outcome, Work, sample_plan
from .program import Program
from .session import Cell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .model import Transfer

TURNS = 5
PORT = 14650
TIMEOUT = 60.0
CLIENTS = (OURS, "MAVSDK", "MAVSDK, bursts")
#: Seconds after the start of a vehicle: its telemetry has begun.
SETTLING_TIME = 1.5
REFERENCE = Program("reference", Work.PARAMETERS, "peer_pymavlink", "parameters")
PLAN_UP = Program("preparation", Work.MISSION_UP, "ours", "mission-up")
PLAN_DOWN = Program("validation", Work.MISSION_DOWN, "ours", "mission-down")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the transfers, and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.transfers.direct", description="Compare transfers."
    )
    parser.add_argument("--works", nargs="+", type=Work, choices=list(Work), default=list(Work))
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument("--json", action="store_true", help="every turn, for a script")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="mavstack-direct-") as folder:
        cells = [_cell(work, options.turns, Path(folder)) for work in options.works]
    print((report.as_json if options.json else report.table)(cells))


def _cell(work: Work, turns: int, folder: Path) -> Cell:
    served, received = folder / "served", folder / "received"
    served.mkdir(exist_ok=True)
    received.mkdir(exist_ok=True)
    is_file = work is Work.FILE
    vehicle = vehicles.ours(served, vehicles.LARGE_FILE) if is_file else vehicles.simulated()
    endpoint = Endpoint(PORT, received, TIMEOUT, vehicle.remote_file, sample_plan())
    clients = [item for item in transfers(work, vehicle) if item.name in CLIENTS]
    outcomes: dict[str, list[Outcome]] = {item.name: [] for item in clients}
    expected = _expected(work, vehicle, endpoint)
    for _ in range(turns):
        for client in clients:
            outcome = _turn(client, vehicle, endpoint, expected)
            if sys.stderr.isatty():
                print(work, client.name, outcome.seconds, outcome.problem, file=sys.stderr)
            outcomes[client.name].append(outcome)
    return Cell(vehicle.name, vehicles.DIRECT, work, outcomes)


def _turn(
    client: Transfer, vehicle: vehicles.Vehicle, endpoint: Endpoint, expected: validation.Expected
) -> Outcome:
    (endpoint.folder / vehicles.LARGE_FILE).unlink(missing_ok=True)
    with vehicle.running(PORT, vehicles.DIRECT):
        if client.work is Work.MISSION_DOWN:
            PLAN_UP.run(endpoint)
        time.sleep(SETTLING_TIME)
        result = client.run(endpoint)
        if client.work is Work.MISSION_UP and result.seconds is not None:
            result = replace(result, plan=PLAN_DOWN.run(endpoint).plan)
    return validation.outcome(client.work, result, expected)


def _expected(work: Work, vehicle: vehicles.Vehicle, endpoint: Endpoint) -> validation.Expected:
    parameters: dict[str, float] = {}
    if work is Work.PARAMETERS:
        with vehicle.running(PORT, vehicles.DIRECT):
            parameters = REFERENCE.run(endpoint).parameters
    file = vehicle.file() if work is Work.FILE else b""
    return validation.Expected(parameters, frozenset(), file, sample_plan(), home_first=False)


if __name__ == "__main__":
    main()
