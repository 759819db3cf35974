"""The check of a show before it is flown: separation, speeds and accelerations over its whole time.

It samples the show 25 times a second. Vehicles that are both on the ground are not counted: they start nearer
to each other than they may fly. Accelerations are those over half a second, since a trajectory of straight
lines has corners, which a vehicle rounds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import MissingExtraError
from mavstack.swarm.separation import scaled
from mavstack.swarm.transitions import Limits

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.shows.show import Show

#: Samples per second.
RATE: Final = 25.0
#: A vehicle less than this many metres above its lowest position is on the ground.
GROUND: Final = 1.0
_SPAN: Final = 0.5


@dataclass(frozen=True, slots=True)
class ShowLimits:
    """Limits of a show.

    Attributes:
        separation: Metres between two vehicles, heights divided by 2.
        motion: Speeds and accelerations of each vehicle.
        highest: Metres above the ground.
        radius: Metres from the origin over ground.
    """

    separation: float = 2.0
    motion: Limits = field(default_factory=lambda: Limits(speed=8.0, climb=3.0, acceleration=4.0))
    highest: float = 150.0
    radius: float = 500.0


@dataclass(frozen=True, slots=True)
class ShowReport:
    """The result of a check.

    Attributes:
        duration: Seconds.
        separation: The smallest distance of two vehicles in metres; infinite for one vehicle.
        speed: The largest speed over ground in m/s.
        climb: The largest vertical speed in m/s.
        acceleration: The largest acceleration in m/s².
        problems: The limits that are passed, as sentences.
    """

    duration: float
    separation: float
    speed: float
    climb: float
    acceleration: float
    problems: tuple[str, ...]


def check_show(show: Show, limits: ShowLimits | None = None) -> ShowReport:
    """Check a show over its whole time.

    Args:
        show: The show.
        limits: The limits; None: the defaults.

    Raises:
        MissingExtraError: scipy is not installed.
    """
    limit = limits or ShowLimits()
    times = np.arange(0.0, show.duration + 0.5 / RATE, 1.0 / RATE)
    places = np.array([each.trajectory.positions(times) for each in show.vehicles])
    speeds = np.array([each.trajectory.velocities(times) for each in show.vehicles])
    late = np.array([each.trajectory.velocities(times + _SPAN / 2.0) for each in show.vehicles])
    early = np.array([each.trajectory.velocities(times - _SPAN / 2.0) for each in show.vehicles])
    near, when, pair = _nearest(places)
    values = {
        "speed over ground": (np.hypot(speeds[..., 0], speeds[..., 1]), limit.motion.speed, "m/s"),
        "vertical speed": (np.abs(speeds[..., 2]), limit.motion.climb, "m/s"),
        "acceleration": (np.linalg.norm(late - early, axis=2) / _SPAN, limit.motion.acceleration, "m/s²"),
        "height": (places[..., 2], limit.highest, "m"),
        "distance from the origin": (np.hypot(places[..., 0], places[..., 1]), limit.radius, "m"),
    }
    problems = []
    if near < limit.separation:
        first, second = (show.vehicles[index].name for index in pair)
        problems.append(
            f"{first} and {second} are {near:.2f} m apart at {times[when]:.1f} s, "
            f"{limit.separation:.3g} m is the limit"
        )
    for name, (found, allowed, unit) in values.items():
        vehicle, index = np.unravel_index(int(found.argmax()), found.shape)
        if found[vehicle, index] > allowed:
            problems.append(
                f"the {name} of {show.vehicles[int(vehicle)].name} is {found[vehicle, index]:.1f} {unit} at "
                f"{times[index]:.1f} s, {allowed:g} {unit} is the limit"
            )
    return ShowReport(
        show.duration,
        near,
        speed=float(values["speed over ground"][0].max()),
        climb=float(values["vertical speed"][0].max()),
        acceleration=float(values["acceleration"][0].max()),
        problems=tuple(problems),
    )


def _nearest(places: Points) -> tuple[float, int, tuple[int, int]]:
    """Return the smallest distance, its sample, and the two vehicles."""
    try:
        from scipy.spatial import cKDTree
    except ImportError as error:
        raise MissingExtraError("shows need scipy", "swarm") from error
    best, when, pair = math.inf, 0, (0, 0)
    flying = places[..., 2] > places[..., 2].min(axis=1, keepdims=True) + GROUND
    for index in range(places.shape[1]):
        in_air = np.nonzero(flying[:, index])[0]
        if not len(in_air) or len(places) < 2:
            continue
        space = scaled(places[:, index])
        found, others = cKDTree(space).query(space[in_air], k=2)
        vehicle = int(found[:, 1].argmin())
        if found[vehicle, 1] < best:
            best, when = float(found[vehicle, 1]), index
            pair = (int(in_air[vehicle]), int(others[vehicle, 1]))
    return best, when, pair
