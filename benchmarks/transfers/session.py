"""The run: a vehicle under a condition, the clients in turn, each turn judged.

For every vehicle and condition the vehicle is started anew. What is right is read over the clean relay first.
Before each turn the clean relay carries what the turn needs: sessions closed and, for an upload, an empty
plan, for a download the sample plan; after an upload it carries the plan back, which is what is judged. The
relay of the turn has a seed that is the same for every client, and another in every turn.
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

from . import judge
from .clients import transfers
from .model import Endpoint, Outcome, Work, sample_plan
from .program import Program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from .model import Result, Transfer
    from .vehicles import Vehicle

VEHICLE_PORT = 14550
GROUND_PORT = 14600
WARM_UP = 12.0  # until a simulated vehicle has settled and sends what it normally sends
PREPARE_LIMIT = 60.0
TRIES = 3

READ = Program("reference", Work.PARAMETERS, "peer_pymavlink", "parameters")
PLAN_UP = Program("reference", Work.MISSION_UP, "peer_pymavlink", "mission-up")
PLAN_DOWN = Program("reference", Work.MISSION_DOWN, "peer_pymavlink", "mission-down")
PLAN_CLEAR = Program("reference", Work.MISSION_UP, "peer_pymavlink", "mission-clear")
SETTLE = Program("reference", Work.FILE, "peer_pymavlink", "settle")


class PreparationError(Exception):
    """What must succeed over the clean relay did not."""


@dataclass(frozen=True, slots=True)
class Run:
    """How much is run."""

    conditions: Sequence[str]
    works: Sequence[Work]
    turns: int
    limit: float
    say: Callable[[str], None]
    only: Sequence[str] = ()  # clients, by name; all if empty


@dataclass(frozen=True, slots=True)
class Cell:
    """Everyone's turns at one piece of work with one vehicle under one condition."""

    vehicle: str
    condition: str
    work: Work
    outcomes: dict[str, list[Outcome]]


@contextmanager
def relayed(condition: str, seed: int) -> Iterator[None]:
    """A relay in a process of its own, between the vehicle's port and the ground's."""
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
            said, _ = process.communicate()
            json.loads(said)


def measure(vehicles: Sequence[Vehicle], run: Run) -> Iterator[Cell]:
    """All cells, one after the other."""
    with tempfile.TemporaryDirectory(prefix="mavstack-transfers-") as folder:
        for vehicle in vehicles:
            for condition in run.conditions:
                with vehicle.running(VEHICLE_PORT, condition):
                    time.sleep(WARM_UP)
                    yield from _Bench(vehicle, condition, run, Path(folder)).cells()


class _Bench:
    """One vehicle, running, under one condition."""

    def __init__(self, vehicle: Vehicle, condition: str, run: Run, folder: Path) -> None:
        self._vehicle = vehicle
        self._condition = condition
        self._run = run
        self._folder = folder
        self._clean = Endpoint(GROUND_PORT, folder, PREPARE_LIMIT, vehicle.remote_file, sample_plan())
        self._ground = replace(self._clean, limit=run.limit)

    def cells(self) -> Iterator[Cell]:
        """Every work that the vehicle does and the run asks for."""
        works = [work for work in self._run.works if work in self._vehicle.works]
        expected = self._expected(works)
        for work in works:
            clients = [
                one
                for one in transfers(work, self._vehicle)
                if not self._run.only or one.name in self._run.only
            ]
            outcomes: dict[str, list[Outcome]] = {one.name: [] for one in clients}
            for turn in range(self._run.turns):
                for client in clients:
                    outcomes[client.name].append(self._turn(client, turn, expected))
            yield Cell(self._vehicle.name, self._condition, work, outcomes)

    def _expected(self, works: Sequence[Work]) -> judge.Expected:
        self._over_clean(SETTLE)
        first, second = ({}, {}) if Work.PARAMETERS not in works else (self._parameters(), self._parameters())
        return judge.Expected(
            parameters=first,
            volatile=judge.volatile(first, second),
            file=self._vehicle.file() if Work.FILE in works else b"",
            plan=sample_plan(),
            home_first=self._vehicle.home_first,
        )

    def _parameters(self) -> dict[str, float]:
        return self._over_clean(READ).parameters

    def _turn(self, client: Transfer, turn: int, expected: judge.Expected) -> Outcome:
        try:
            return self._judged_turn(client, turn, expected)
        except PreparationError as problem:
            self._run.say(f"{self._vehicle.name} {self._condition} {client.work} {client.name}: {problem}")
            return Outcome(None, str(problem))

    def _judged_turn(self, client: Transfer, turn: int, expected: judge.Expected) -> Outcome:
        self._prepare(client.work)
        with relayed(self._condition, turn):
            result = client.run(self._ground)
        if client.work is Work.MISSION_UP and result.seconds is not None:
            result = replace(result, plan=self._over_clean(PLAN_DOWN).plan)
        judged = judge.outcome(client.work, result, expected)
        if judged.problem and result.parameters:  # the vehicle may have changed some by itself
            changed = judge.volatile(expected.parameters, self._parameters())
            judged = judge.outcome(
                client.work, result, replace(expected, volatile=expected.volatile | changed)
            )
        took = f"{result.seconds:.2f} s" if result.seconds is not None else "never"
        self._run.say(
            f"{self._vehicle.name} {self._condition} {client.work} {client.name}: {took} {judged.problem}"
        )
        return judged

    def _prepare(self, work: Work) -> None:
        if self._vehicle.remote_file:
            (self._folder / Path(self._vehicle.remote_file).name).unlink(missing_ok=True)
        self._over_clean(SETTLE)
        if work is Work.MISSION_UP:
            self._over_clean(PLAN_CLEAR)
        elif work is Work.MISSION_DOWN:
            self._over_clean(PLAN_UP)

    def _over_clean(self, program: Program) -> Result:
        """Do something that must succeed."""
        for _ in range(TRIES):
            with relayed("a", 0):
                result = program.run(self._clean)
            if result.seconds is not None and not result.problem:
                return result
            time.sleep(2.0)
        raise PreparationError(f"{program.what} over a clean link: {result.problem}")
