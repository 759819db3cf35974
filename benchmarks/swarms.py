"""Planning for a thousand vehicles: the row `swarms`, and `python -m benchmarks.swarms`.

A step of the avoidance in three dimensions takes turns with a step of pyrvo's RVO2 in two dimensions, for the
same positions, velocities and number of neighbours. pyrvo's agents are made before the measured time, and its
velocities are read within it. The assignment of slots takes turns with the solvers of scipy and ortools; the
time of making their matrix of squared distances counts as theirs.
"""

from __future__ import annotations

import statistics
import time
from functools import partial
from itertools import permutations
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.swarm.assignment import assign_slots
from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.formations import FORMATIONS, Formation

from .measure import OURS, Ratio, Row, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.swarm.arrays import Points

    from .rows import Bench

COUNT: Final = 1000
NEIGHBOURS: Final = 30
#: Seconds that a step of the avoidance, and an assignment, may take.
STEP_TARGET: Final = 0.010
ASSIGNMENT_TARGET: Final = 0.100
PYRVO: Final = "pyrvo (2D)"
#: The formations that need nothing but a number of vehicles.
SHAPES: Final = sorted(set(FORMATIONS) - {"points", "text"})
_DISTANCE, _HORIZON, _SPEED, _STEP = 4.0, 5.0, 5.0, 0.1


def rows(bench: Bench) -> Iterator[Row]:
    """Measure a step of the avoidance beside pyrvo, and an assignment."""
    turns = bench.amounts.turns
    results = measure_steps(turns)
    steps = results[OURS]
    within = Ratio(
        f"of {STEP_TARGET * 1e3:.0f} ms", tuple(x / STEP_TARGET for x in steps), 1, higher_is_better=False
    )
    yield Row(
        f"avoidance, {COUNT:,} vehicles", _medians(results), (within, speed_ratio(results, PYRVO, None))
    )
    times = measure_assignments("grid", "wedge", max(turns // 2, 3))
    share = tuple(x / ASSIGNMENT_TARGET for x in times[OURS])
    limit = Ratio(f"of {ASSIGNMENT_TARGET * 1e3:.0f} ms", share, 1, higher_is_better=False)
    peers = [speed_ratio(times, name, None) for name in times if name != OURS]
    yield Row(f"assignment, {COUNT:,} vehicles", _medians(times), (limit, *peers))


def measure_steps(turns: int) -> dict[str, list[float]]:
    """Return the seconds of each step, ours and pyrvo's."""
    positions, velocities, preferred = _vehicles()
    avoidance = Avoidance(_DISTANCE, _HORIZON, _SPEED, neighbours=NEIGHBOURS, step=_STEP)
    ours = _timed(lambda: avoidance.targets(positions, velocities, preferred))
    return take_turns({OURS: ours, PYRVO: _pyrvo_step(positions, velocities, preferred)}, turns)


def measure_assignments(shape: str, other: str, turns: int) -> dict[str, list[float]]:
    """Return the seconds of each assignment of one formation to another, ours and the peers'."""
    starts, slots = Formation(shape).offsets(COUNT), Formation(other).offsets(COUNT)
    works: dict[str, Callable[[], object]] = {
        OURS: lambda: assign_slots(starts, slots),
        "scipy": lambda: _assign_by_scipy(starts, slots),
        "ortools": lambda: _assign_by_ortools(starts, slots),
    }
    return take_turns({name: _timed(work) for name, work in works.items()}, turns)


def _assign_by_scipy(starts: Points, slots: Points) -> None:
    from scipy.optimize import linear_sum_assignment

    linear_sum_assignment(_squared_distances(starts, slots))


def _assign_by_ortools(starts: Points, slots: Points) -> None:
    from ortools.graph.python.linear_sum_assignment import SimpleLinearSumAssignment

    costs = np.rint(_squared_distances(starts, slots) * 1000.0).astype(np.int64)
    rows, columns = np.indices(costs.shape, np.int32)
    solver = SimpleLinearSumAssignment()
    solver.add_arcs_with_cost(rows.ravel(), columns.ravel(), costs.ravel())
    solver.solve()


def _squared_distances(starts: Points, slots: Points) -> Points:
    squares: Points = ((starts[:, None] - slots[None]) ** 2).sum(axis=2)
    return squares


def _medians(times: dict[str, list[float]]) -> dict[str, str]:
    return {name: f"{statistics.median(each) * 1e3:.1f} ms" for name, each in times.items()}


def main(turns: int = 7) -> None:
    """Measure in turns, and print a line for each; then each pair of formations, in both directions."""
    for name, times in measure_steps(turns).items():
        print(f"avoidance of {COUNT} vehicles, {name}: {statistics.median(times) * 1e3:.2f} ms")
    for name, figure in _medians(measure_assignments("grid", "wedge", turns)).items():
        print(f"assignment of {COUNT} vehicles, grid to wedge, {name}: {figure}")
    for shape, other in permutations(SHAPES, 2):
        starts, slots = Formation(shape).offsets(COUNT), Formation(other).offsets(COUNT)
        pair = take_turns({OURS: _timed(partial(assign_slots, starts, slots))}, turns)
        print(f"assignment of {COUNT} vehicles, {shape} to {other}: {_medians(pair)[OURS]}")


def _vehicles() -> tuple[Points, Points, Points]:
    """Return vehicles on a loose grid in one plane, each on a random course."""
    random = np.random.default_rng(1)
    side = int(np.ceil(np.sqrt(COUNT)))
    index = np.arange(COUNT)
    ground = np.column_stack((index // side, index % side)) * 7.0 + random.uniform(-1.0, 1.0, (COUNT, 2))
    flat = np.zeros((COUNT, 1))
    velocities, preferred = random.uniform(-3.0, 3.0, (2, COUNT, 2))
    return np.hstack((ground, flat)), np.hstack((velocities, flat)), np.hstack((preferred, flat))


def _pyrvo_step(positions: Points, velocities: Points, preferred: Points) -> Callable[[], float]:
    import pyrvo

    def run() -> float:
        simulator = pyrvo.RVOSimulator()
        simulator.set_time_step(_STEP)
        simulator.set_agent_defaults(100.0, NEIGHBOURS, _HORIZON, _HORIZON, _DISTANCE / 2.0, _SPEED)
        for place, velocity, wanted in zip(positions, velocities, preferred, strict=True):
            agent = simulator.add_agent(place[:2].tolist())
            simulator.set_agent_velocity(agent, velocity[:2].tolist())
            simulator.set_agent_pref_velocity(agent, wanted[:2].tolist())
        begin = time.perf_counter()
        simulator.do_step()
        for agent in range(COUNT):
            simulator.get_agent_velocity(agent)
        return time.perf_counter() - begin

    return run


def _timed(work: Callable[[], object]) -> Callable[[], float]:
    def run() -> float:
        begin = time.perf_counter()
        work()
        return time.perf_counter() - begin

    return run


if __name__ == "__main__":
    main()
