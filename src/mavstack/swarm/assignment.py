"""Which vehicle takes which slot, and which task.

Slots are assigned so that the sum of the squared distances is smallest. That choice has a second use:
straight lines of equal duration between starts and goals do not cross in time then (Turpin et al. 2014,
CAPT), see `transitions`. Squared distances also prefer two short ways to a long and a short one, so that
the last vehicle arrives early.

Tasks are assigned by an auction (CBBA's first phase with one bidder at a time, which suffices where one
program knows all bids): the task that adds least to the work of some vehicle goes to it next. For travel
costs the result is at most twice the optimum of the largest share in practice; tests compare it with the
optimum.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Indices, Points

Singles: TypeAlias = npt.NDArray[np.float32]

#: Costs are reduced by Sinkhorn's iteration only if there are at least this many vehicles.
_SMALLEST_REDUCED: Final = 100
#: The largest cost in units of Sinkhorn's iteration, chosen so that its exponential does not underflow, and
#: the number of iterations in each stage.
_SINKHORN_RANGE: Final = 70.0
_SINKHORN_STEPS: Final = 20
#: The unit of each stage is the unit of the first stage divided by this number.
_SINKHORN_STAGES: Final = (1.0, 6.0, 36.0)
#: Points are on one line if they are no further from it than this part of its length.
_LINE_TOLERANCE: Final = 1e-9


def assign_slots(starts: Points, slots: Points) -> Indices:
    """Return the slot of each vehicle.

    Args:
        starts: Positions of the vehicles in metres, an array of shape (n, 3).
        slots: Positions of at least n slots.

    Returns:
        The index of the slot of each vehicle.

    Raises:
        InvalidArgumentError: There are fewer slots than vehicles.
        MissingExtraError: scipy is not installed.
    """
    if len(slots) < len(starts):
        raise InvalidArgumentError(
            f"there must be a slot for each vehicle, got {len(slots)} for {len(starts)}"
        )
    if len(slots) == len(starts) and np.isfinite(starts).all() and np.isfinite(slots).all():
        for line in (slots, starts):
            direction = _common_direction(line)
            if direction is not None:
                return _sorted_along(direction, starts, slots)
    return optimal_assignment(squared_distances(starts, slots))


def _common_direction(points: Points) -> Points | None:
    """Return the direction of the line on which all points are, from the first one; None: on none."""
    apart = points - points[:1]
    lengths = np.linalg.norm(apart, axis=1)
    length = float(lengths.max(initial=0.0))
    if length == 0.0:
        return np.zeros(3)
    direction: Points = apart[lengths.argmax()] / length
    beside = apart - np.outer(apart @ direction, direction)
    return direction if np.abs(beside).max() <= _LINE_TOLERANCE * length else None


def _sorted_along(direction: Points, starts: Points, slots: Points) -> Indices:
    """Return the slot of each vehicle if all starts or all slots are on a line in this direction.

    The sum of the squared distances is a constant minus twice the sum of the products of start and slot. Of
    points beside the line, these products contain the places along it alone, and such a sum is largest if
    both are in the same order. The solver is slowest for these formations, since many sums are equal.
    """
    chosen = np.empty(len(starts), np.int64)
    chosen[_order_along(direction, starts)] = _order_along(direction, slots)
    return chosen


def _order_along(direction: Points, points: Points) -> Indices:
    """Return the indices of points in their order along a direction, those at the same place as they are."""
    places = (points - np.mean(points, axis=0)) @ direction
    unit = _LINE_TOLERANCE * max(float(np.abs(places).max(initial=0.0)), 1.0)
    order: Indices = np.argsort(np.rint(places / unit), kind="stable")
    return order


def optimal_assignment(costs: Points) -> Indices:
    """Return the column of each row with the smallest sum of costs.

    Args:
        costs: An array with a row for each vehicle and at least as many columns.

    Raises:
        MissingExtraError: scipy is not installed.
    """
    try:
        from scipy.optimize import linear_sum_assignment
    except ImportError as error:
        raise MissingExtraError("swarms need scipy", "swarm") from error
    # Vehicles of a formation are in the order of their ranks; the solver is faster if neighbours are not one
    # after the other, since each one then finds a free slot nearby.
    order = np.random.default_rng(0).permutation(len(costs))
    _, columns = linear_sum_assignment(_reduced(costs)[order])
    chosen = np.empty(len(costs), np.int64)
    chosen[order] = columns
    return chosen


def _reduced(costs: Points) -> Points:
    """Return costs with the same optimum, from which a number was subtracted in each row and column.

    The solver begins without prices of rows and columns and finds one path after the other; with prices near
    the optimal ones most paths are one step. Sinkhorn's iteration finds them: it scales exp(-cost / unit)
    until all rows and columns have the same sum. The unit of the first stage is a part of the largest cost,
    whose exponential must not be 0; each further stage begins with the prices of the one before and has a
    smaller unit, which resolves the differences of neighbouring slots in long formations. At the end the
    prices are raised until each row and each column has a cost of 0 and none is negative, so that the solver
    finds a free slot at once for most vehicles. With more columns than rows the optimum would change, so such
    costs stay as they are.
    """
    rows, columns = costs.shape
    largest = float(costs.max(initial=0.0))
    if rows != columns or rows < _SMALLEST_REDUCED or not (0.0 < largest < np.inf and costs.min() >= 0.0):
        return costs
    single, row_prices, column_prices = costs.astype(np.float32), np.zeros(rows), np.zeros(columns)
    kernel = np.empty_like(single)
    for part in _SINKHORN_STAGES:
        unit = largest / _SINKHORN_RANGE / part
        prices = row_prices.astype(np.float32), column_prices.astype(np.float32)
        np.subtract(prices[0][:, None], single, out=kernel)
        kernel += prices[1]
        across, down = _scales(kernel, unit)
        row_prices += unit * np.log(across.astype(float))
        column_prices += unit * np.log(down.astype(float))
    if not (np.isfinite(row_prices).all() and np.isfinite(column_prices).all()):
        return costs
    reduced: Points = costs - row_prices[:, None]
    reduced -= column_prices
    reduced -= reduced.min(axis=1)[:, None]
    reduced -= reduced.min(axis=0)
    return reduced


def _scales(kernel: Singles, unit: float) -> tuple[Singles, Singles]:
    """Return the scales of rows and columns after one stage of Sinkhorn's iteration.

    Args:
        kernel: The prices minus the costs; used up.
        unit: The unit of the stage.
    """
    kernel *= np.float32(1.0 / unit)
    np.maximum(kernel, -_SINKHORN_RANGE, out=kernel)
    np.exp(kernel, out=kernel)
    across: Singles = np.ones(len(kernel), np.float32)
    down: Singles = np.ones(kernel.shape[1], np.float32)
    for _ in range(_SINKHORN_STEPS):
        np.divide(1.0, kernel @ down, out=across)
        np.divide(1.0, across @ kernel, out=down)
    return across, down


def squared_distances(starts: Points, goals: Points) -> Points:
    """Return the squared distance of each start and goal, an array of shape (starts, goals)."""
    centre = np.mean(starts, axis=0) if len(starts) else 0.0
    begin, end = np.asarray(starts, dtype=float) - centre, np.asarray(goals, dtype=float) - centre
    # In one array: each further one of a million numbers costs more than the arithmetic.
    squares: Points = begin @ (-2.0 * end).T
    squares += (begin * begin).sum(axis=1)[:, None]
    squares += (end * end).sum(axis=1)
    np.maximum(squares, 0.0, out=squares)
    return squares


def auction_tasks(starts: Points, tasks: Points, speeds: Sequence[float] | None = None) -> list[list[int]]:
    """Divide tasks among vehicles so that the last one ends early.

    Args:
        starts: Positions of the vehicles in metres, an array of shape (n, 3).
        tasks: Positions of the tasks, an array of shape (m, 3).
        speeds: Speed of each vehicle in m/s; None: all are equally fast.

    Returns:
        The indices of the tasks of each vehicle, in the order in which it visits them.

    Raises:
        InvalidArgumentError: There is no vehicle, or a speed is not positive.
    """
    pace = np.ones(len(starts)) if speeds is None else np.asarray(speeds, dtype=float)
    if not len(starts) or len(pace) != len(starts) or not (pace > 0.0).all():
        raise InvalidArgumentError("each vehicle must have a speed above 0 m/s")
    routes: list[list[int]] = [[] for _ in starts]
    lengths = np.zeros(len(starts))
    open_tasks = list(range(len(tasks)))
    while open_tasks:
        bids = [
            _best_bid(np.asarray(starts), np.asarray(tasks), routes, lengths, pace, task)
            for task in open_tasks
        ]
        task_index = min(range(len(bids)), key=lambda index: bids[index][0])
        _, vehicle, position, added = bids[task_index]
        routes[vehicle].insert(position, open_tasks.pop(task_index))
        lengths[vehicle] += added
    return routes


def _best_bid(
    starts: Points, tasks: Points, routes: list[list[int]], lengths: Points, pace: Points, task: int
) -> tuple[float, int, int, float]:
    """Return the earliest end for a task: time, vehicle, place in its route, metres added."""
    best = (float("inf"), 0, 0, 0.0)
    for vehicle, route in enumerate(routes):
        position, added = _insertion(np.vstack((starts[vehicle], tasks[route])), tasks[task])
        end = (lengths[vehicle] + added) / pace[vehicle]
        if end < best[0]:
            best = (float(end), vehicle, position, added)
    return best


def _insertion(stops: Points, place: Points) -> tuple[int, float]:
    """Return where in a route a place adds least, and the metres that it adds."""
    to_place = np.linalg.norm(stops - place, axis=1)
    legs = np.linalg.norm(stops[1:] - stops[:-1], axis=1)
    added = np.append(to_place[:-1] + to_place[1:] - legs, to_place[-1])
    best = int(added.argmin())
    return best, float(added[best])
