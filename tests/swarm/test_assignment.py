"""Assignment of slots and tasks, beside brute force."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.assignment import assign_slots, auction_tasks, squared_distances
from mavstack.swarm.formations import FORMATIONS, Formation


@given(st.integers(0, 10**6), st.integers(1, 6))
def test_no_other_assignment_has_a_smaller_sum_of_squared_distances(seed, count):
    random = np.random.default_rng(seed)
    starts, slots = random.uniform(-100, 100, (2, count, 3))
    chosen = assign_slots(starts, slots)
    costs = ((starts[:, None] - slots[None]) ** 2).sum(axis=2)
    best = min(
        sum(costs[index, slot] for index, slot in enumerate(order)) for order in permutations(range(count))
    )
    assert sorted(chosen) == list(range(count))
    assert costs[np.arange(count), chosen].sum() == pytest.approx(best)


@given(
    st.integers(0, 10**6),
    st.integers(1, 40),
    st.sampled_from(sorted(set(FORMATIONS) - {"points", "text"})),
    st.sampled_from(["line", "column", "echelon", "places"]),
    st.booleans(),
)
def test_vehicles_on_a_line_and_slots_on_a_line_have_the_optimum_of_scipy(seed, count, shape, line, back):
    random = np.random.default_rng(seed)
    slots = Formation(line if line != "places" else "line").offsets(count)
    if line == "places":
        slots *= random.integers(0, 3, (count, 1))
    starts = random.permutation(Formation(shape).offsets(count)) + random.uniform(-500.0, 500.0, 3)
    if random.integers(2):
        starts += random.normal(0.0, 0.5, starts.shape)
    if back:
        starts, slots = slots, starts
    chosen = assign_slots(starts, slots)
    costs = squared_distances(starts, slots)
    assert sorted(chosen) == list(range(count))
    assert costs[np.arange(count), chosen].sum() == pytest.approx(
        costs[linear_sum_assignment(costs)].sum(), rel=1e-9
    )


def test_members_at_the_same_place_along_a_line_keep_their_order():
    line, column = Formation("line").offsets(9), Formation("column").offsets(9)
    assert assign_slots(line, column).tolist() == list(range(9))


def test_unknown_positions_are_not_sorted():
    starts = Formation("wedge").offsets(4)
    starts[2, 1] = np.nan
    with pytest.raises(ValueError, match="invalid numeric entries"):
        assign_slots(starts, Formation("column").offsets(4))


@pytest.mark.parametrize("shape", ["random", "grids", "line", "wedge", "equal"])
def test_large_assignments_have_the_optimum_of_ortools(shape):
    assignment = pytest.importorskip("ortools.graph.python.linear_sum_assignment")
    random, count = np.random.default_rng(3), 150
    starts, slots = random.uniform(-100, 100, (2, count, 3))
    if shape == "grids":
        index = np.arange(count)
        slots = np.column_stack((index // 12 * 10.0, index % 12 * 10.0, 0.0 * index))
        starts = random.permutation(slots) + np.array((300.0, 0.0, 5.0))
    if shape in ("line", "wedge"):
        starts, slots = Formation("grid").offsets(count), Formation(shape).offsets(count)
    if shape == "equal":
        slots = np.zeros((count, 3))
    costs = np.rint(squared_distances(starts, slots) * 1000.0).astype(np.int64)
    solver = assignment.SimpleLinearSumAssignment()
    rows, columns = np.indices(costs.shape)
    solver.add_arcs_with_cost(rows.ravel(), columns.ravel(), costs.ravel())
    assert solver.solve() == solver.OPTIMAL
    chosen = assign_slots(starts, slots)
    assert sorted(chosen) == list(range(count))
    assert costs[np.arange(count), chosen].sum() == pytest.approx(solver.optimal_cost(), rel=1e-6)


def test_the_solver_finds_a_free_slot_in_each_row_and_column(monkeypatch):
    given_costs = []

    def solve(costs):
        given_costs.append(costs)
        return linear_sum_assignment(costs)

    monkeypatch.setattr("scipy.optimize.linear_sum_assignment", solve)
    assign_slots(Formation("wedge").offsets(150), Formation("grid").offsets(150))
    (costs,) = given_costs
    assert costs.min() >= 0.0
    assert not costs.min(axis=0).any()
    assert (costs.min(axis=1) < 1e-6 * costs.max()).all()


def test_there_may_be_more_slots_but_not_fewer():
    assert assign_slots(np.zeros((1, 3)), np.array([[9.0, 0, 0], [1.0, 0, 0]])).tolist() == [1]
    with pytest.raises(InvalidArgumentError, match="a slot for each vehicle, got 1 for 2"):
        assign_slots(np.zeros((2, 3)), np.zeros((1, 3)))


def test_squared_distances_far_from_the_origin_are_exact():
    places = np.array([[1e6, 2e6, 0.0], [1e6 + 3.0, 2e6 + 4.0, 0.0]])
    assert squared_distances(places, places).tolist() == [[0.0, 25.0], [25.0, 0.0]]


@given(st.integers(0, 10**6), st.integers(1, 5), st.integers(0, 12))
def test_each_task_has_one_vehicle(seed, vehicles, tasks):
    random = np.random.default_rng(seed)
    routes = auction_tasks(random.uniform(0, 100, (vehicles, 3)), random.uniform(0, 100, (tasks, 3)))
    assert sorted(task for route in routes for task in route) == list(range(tasks))


def optimal_end(starts, tasks):
    """Return the earliest time at which the last vehicle can end at 1 m/s, by ortools."""
    cp_model = pytest.importorskip("ortools.sat.python.cp_model")
    model = cp_model.CpModel()
    end = model.new_int_var(0, 100_000, "end")
    visits = [[] for _ in tasks]
    for start in starts:
        places = np.vstack((start, tasks))
        lengths = np.rint(100.0 * np.linalg.norm(places[:, None] - places[None], axis=2)).astype(int)
        arcs, way = [], []
        for one in range(len(places)):
            for other in range(len(places)):
                arc = model.new_bool_var("")
                arcs.append((one, other, arc))
                if one == other and one:  # left out
                    visits[one - 1].append(arc.negated())
                elif other:  # the way back to the start costs nothing
                    way.append(int(lengths[one, other]) * arc)
        model.add_circuit(arcs)
        model.add(sum(way) <= end)
    for each in visits:
        model.add_exactly_one(each)
    model.minimize(end)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    assert solver.solve(model) == cp_model.OPTIMAL
    return solver.objective_value / 100.0


@pytest.mark.parametrize("seed", range(4))
def test_an_auction_ends_within_twice_the_optimum_of_ortools(seed):
    random = np.random.default_rng(seed)
    starts, tasks = random.uniform(0, 100, (3, 3)), random.uniform(0, 100, (6, 3))
    ends = []
    for start, route in zip(starts, auction_tasks(starts, tasks), strict=True):
        places = np.vstack((start, tasks[route]))
        ends.append(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    best = optimal_end(starts, tasks)
    assert best - 0.1 <= max(ends) <= 2.0 * best


def test_a_fast_vehicle_takes_more_tasks():
    tasks = np.array([[float(10 * index), 0.0, 0.0] for index in range(1, 13)])
    slow, fast = auction_tasks(np.zeros((2, 3)), tasks, [1.0, 5.0])
    assert len(fast) > 2 * len(slow)
    with pytest.raises(InvalidArgumentError, match="a speed above 0 m/s"):
        auction_tasks(np.zeros((2, 3)), tasks, [1.0, 0.0])
