"""Rangefinders of simulated vehicles: kind, orientation and range, and their measurement.

A rangefinder measures along its axis to the ground or to the nearest obstacle. A proximity sensor measures in
`SECTORS` horizontal sectors around the vehicle.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, isfinite, radians, sin
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.sim.motion.obstacles import turned

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Self

    from mavstack.sim.motion import Motion
    from mavstack.sim.motion.obstacles import Point, Surroundings

_KIND, _ORIENTATION = common.MavDistanceSensor, common.MavSensorOrientation

#: Orientations by the names that `mav sim` accepts.
ORIENTATIONS: Final[Mapping[str, common.MavSensorOrientation]] = MappingProxyType(
    {
        "downward": _ORIENTATION.PITCH_270,
        "upward": _ORIENTATION.PITCH_90,
        "forward": _ORIENTATION.NONE,
        "right": _ORIENTATION.YAW_90,
        "backward": _ORIENTATION.YAW_180,
        "left": _ORIENTATION.YAW_270,
    }
)
#: Kinds of rangefinders by name.
KINDS: Final[Mapping[str, common.MavDistanceSensor]] = MappingProxyType(
    {"laser": _KIND.LASER, "sonar": _KIND.ULTRASOUND, "infrared": _KIND.INFRARED, "radar": _KIND.RADAR}
)
#: Default minimum and maximum range of each kind, in metres.
_RANGES: Final = MappingProxyType(
    {
        _KIND.LASER: (0.2, 40.0),
        _KIND.ULTRASOUND: (0.2, 7.0),
        _KIND.INFRARED: (0.2, 5.5),
        _KIND.RADAR: (0.5, 50.0),
    }
)
#: Number of horizontal orientations, which are multiples of 45 degrees counted from forward.
_HORIZONTAL: Final = 8
#: Number of sectors of a proximity sensor, as many as OBSTACLE_DISTANCE has, and their width in degrees.
SECTORS: Final = 72
SECTOR_WIDTH: Final = 5
#: Minimum and maximum range of a proximity sensor, in metres.
PROXIMITY_RANGE: Final = (0.2, 40.0)
MAX_RANGEFINDERS: Final = 6
_MAX_RANGE: Final = 650.0


@dataclass(frozen=True, slots=True)
class Rangefinder:
    """A rangefinder.

    Attributes:
        orientation: Its axis: downward (PITCH_270), upward (PITCH_90), or one of the eight horizontal ones.
        kind: The kind of sensor.
        min_distance: Minimum range in metres; None for a usual one of the kind.
        max_distance: Maximum range in metres; None for a usual one of the kind.
    """

    orientation: common.MavSensorOrientation = _ORIENTATION.PITCH_270
    kind: common.MavDistanceSensor = _KIND.LASER
    min_distance: float | None = None
    max_distance: float | None = None

    def __post_init__(self) -> None:
        upright = (_ORIENTATION.PITCH_90, _ORIENTATION.PITCH_270)
        if self.orientation >= _HORIZONTAL and self.orientation not in upright:
            raise InvalidArgumentError(
                f"a simulated rangefinder looks downward, upward or horizontally, not {self.orientation!r}"
            )
        low, high = self.range
        if not 0 < low < high <= _MAX_RANGE:
            raise InvalidArgumentError(
                f"the range of a rangefinder must be within 0 to {_MAX_RANGE:g} m, got {low} to {high}"
            )

    @classmethod
    def parse(cls, text: str) -> Self:
        """Parse `ORIENTATION[:KIND]`, such as `downward:sonar`; raises InvalidArgumentError."""
        orientation, _, kind = text.strip().lower().partition(":")
        kind = kind or "laser"
        if orientation not in ORIENTATIONS or kind not in KINDS:
            raise InvalidArgumentError(
                f"rangefinder {text!r} is not ORIENTATION[:KIND]; orientations: {', '.join(ORIENTATIONS)}; "
                f"kinds: {', '.join(KINDS)}"
            )
        return cls(ORIENTATIONS[orientation], KINDS[kind])

    @property
    def name(self) -> str:
        """Orientation and kind in words, such as "downward sonar"."""
        orientation = next((word for word, value in ORIENTATIONS.items() if value == self.orientation), None)
        kind = next((word for word, value in KINDS.items() if value == self.kind), "unknown")
        return f"{orientation or self.orientation.name.lower()} {kind}"

    @property
    def range(self) -> tuple[float, float]:
        """Minimum and maximum range in metres."""
        low, high = _RANGES.get(self.kind, _RANGES[_KIND.LASER])
        return (
            low if self.min_distance is None else self.min_distance,
            high if self.max_distance is None else self.max_distance,
        )

    @property
    def axis(self) -> Point:
        """The axis in the body: forward, right, down."""
        if self.orientation == _ORIENTATION.PITCH_270:
            return 0.0, 0.0, 1.0
        if self.orientation == _ORIENTATION.PITCH_90:
            return 0.0, 0.0, -1.0
        turn = radians(45.0 * self.orientation)
        return cos(turn), sin(turn), 0.0

    def measure(self, motion: Motion, surroundings: Surroundings) -> float | None:
        """Return the distance in metres, at least the minimum; None if nothing is in range."""
        here = motion.north, motion.east, motion.down
        ray = turned(self.axis, motion.roll, motion.pitch, motion.yaw)
        low, high = self.range
        distance = surroundings.distance_along(here, ray)
        return max(distance, low) if isfinite(distance) and distance <= high else None
