"""The run: one vehicle under one condition, with the clients in turn, and validation of each turn.

The vehicle is restarted for each condition. The expected data is first read over the clean relay. Before each
turn the clean relay is used for preparation: sessions are closed, an upload begins with an empty plan, a
download with the sample plan; after an upload the plan is read back over it and validated. The relay of a
turn has the same seed for every client, and another seed in every turn.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from . import validation
from .clients import transfers
from .model import Endpoint, Outcome, Work, sample_plan
from .program import Program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from .model import Result, Transfer
    from .vehicles import Vehicle

VEHICLE_PORT = 14550
GROUND_PORT = 14600
WARM_UP_TIME = 12.0  # seconds until a simulated vehicle sends its normal telemetry
PREPARE_TIMEOUT = 60.0
MAX_ATTEMPTS = 3

READ = Program("reference", Work.PARAMETERS, "peer_pymavlink", "parameters")
PLAN_UP = Program("reference", Work.MISSION_UP, "peer_pymavlink", "mission-up")
PLAN_DOWN = Program("reference", Work.MISSION_DOWN, "peer_pymavlink", "mission-down")
PLAN_CLEAR = Program("reference", Work.MISSION_UP, "peer_pymavlink", "mission-clear")
SETTLE = Program("reference", Work.FILE, "peer_pymavlink", "settle")


class PreparationError(Exception):
    """A step over the clean relay failed."""


@dataclass(frozen=True, slots=True)
class Run:
    """The extent of a run."""

    conditions: Sequence[str]
    works: Sequence[Work]
    turns: int
    timeout: float
    log: Callable[[str], None]
    only: Sequence[str] = ()  # names of clients; empty for all


@dataclass(frozen=True, slots=True)
class Cell:
    """The turns of all clients at one piece of work with one vehicle under one condition."""

    vehicle: str
    condition: str
    work: Work
    outcomes: dict[str, list[Outcome]]


@contextmanager
def relayed(condition: str, seed: int) -> Iterator[None]:
    """Run a relay in a separate process between the ports of the vehicle and the ground station."""
    command = [sys.executable, "-m", "benchmarks.relay", "--condition", condition, "--seed", str(seed)]
    command += ["--vehicle", str(VEHICLE_PORT), "--ground", str(GROUND_PORT)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2]
    ) as process:
        if process.stdout is None or process.stdout.readline() != "ready\n":
            raise RuntimeError("the relay did not start")
        try:
            yield
        finally:
            output, _ = process.communicate()
            json.loads(output)


def measure(vehicles: Sequence[Vehicle], run: Run) -> Iterator[Cell]:
    """Yield all cells."""
    with tempfile.TemporaryDirectory(prefix="mavstack-transfers-") as folder:
        for vehicle in vehicles:
            for condition in run.conditions:
                with vehicle.running(VEHICLE_PORT, condition):
                    time.sleep(WARM_UP_TIME)
                    yield from _Bench(vehicle, condition, run, Path(folder)).cells()


class _Bench:
    """One running vehicle under one condition."""

    def __init__(self, vehicle: Vehicle, condition: str, run: Run, folder: Path) -> None:
        self._vehicle = vehicle
        self._condition = condition
        self._run = run
        self._folder = folder
        self._clean = Endpoint(GROUND_PORT, folder, PREPARE_TIMEOUT, vehicle.remote_file, sample_plan())
        self._ground = replace(self._clean, timeout=run.timeout)

    def cells(self) -> Iterator[Cell]:
        """Yield a cell for each requested work that the vehicle supports."""
        works = [work for work in self._run.works if work in self._vehicle.works]
        expected = self._expected(works)
        for work in works:
            clients = [
                item
                for item in transfers(work, self._vehicle)
                if not self._run.only or item.name in self._run.only
            ]
            outcomes: dict[str, list[Outcome]] = {item.name: [] for item in clients}
            for turn in range(self._run.turns):
                for client in clients:
                    outcomes[client.name].append(self._turn(client, turn, expected))
            yield Cell(self._vehicle.name, self._condition, work, outcomes)

    def _expected(self, works: Sequence[Work]) -> validation.Expected:
        self._run_clean(SETTLE)
        first, second = ({}, {}) if Work.PARAMETERS not in works else (self._parameters(), self._parameters())
        return validation.Expected(
            parameters=first,
            volatile=validation.volatile(first, second),
            file=self._vehicle.file() if Work.FILE in works else b"",
            plan=sample_plan(),
            home_first=self._vehicle.home_first,
        )

    def _parameters(self) -> dict[str, float]:
        return self._run_clean(READ).parameters

    def _turn(self, client: Transfer, turn: int, expected: validation.Expected) -> Outcome:
        try:
            return self._measured_turn(client, turn, expected)
        except PreparationError as problem:
            self._run.log(f"{self._vehicle.name} {self._condition} {client.work} {client.name}: {problem}")
            return Outcome(None, str(problem))

    def _measured_turn(self, client: Transfer, turn: int, expected: validation.Expected) -> Outcome:
        self._prepare(client.work)
        with relayed(self._condition, turn):
            result = client.run(self._ground)
        if client.work is Work.MISSION_UP and result.seconds is not None:
            result = replace(result, plan=self._run_clean(PLAN_DOWN).plan)
        outcome = validation.outcome(client.work, result, expected)
        if outcome.problem and result.parameters:  # the vehicle may have changed parameters itself
            changed = validation.volatile(expected.parameters, self._parameters())
            outcome = validation.outcome(
                client.work, result, replace(expected, volatile=expected.volatile | changed)
            )
        took = f"{result.seconds:.2f} s" if result.seconds is not None else "failed"
        self._run.log(
            f"{self._vehicle.name} {self._condition} {client.work} {client.name}: {took} {outcome.problem}"
        )
        return outcome

    def _prepare(self, work: Work) -> None:
        if self._vehicle.remote_file:
            (self._folder / Path(self._vehicle.remote_file).name).unlink(missing_ok=True)
        self._run_clean(SETTLE)
        if work is Work.MISSION_UP:
            self._run_clean(PLAN_CLEAR)
        elif work is Work.MISSION_DOWN:
            self._run_clean(PLAN_UP)

    def _run_clean(self, program: Program) -> Result:
        """Run a program over the clean relay, which must succeed."""
        for _ in range(MAX_ATTEMPTS):
            with relayed("a", 0):
                result = program.run(self._clean)
            if result.seconds is not None and not result.problem:
                return result
            time.sleep(2.0)
        raise PreparationError(f"{program.operation} over a clean link: {result.problem}")
