"""Samples from a bus to a vehicle: what is checked before a message of MAVLink is made of them.

A network bus is not a cockpit. A sample that steers is forwarded once, when it arrives, and never repeated,
so that a publisher that stops is one that has stopped. A sample whose header is older than `MAX_AGE` is
refused, numbers must be finite, frames known, quaternions of length 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2, isfinite, sqrt
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from mavstack.bridges.core.view import VehicleView
    from mavstack.rotation import Quaternion, Vector
    from mavstack.services import Address

#: Maximum age in nanoseconds of a sample that steers the vehicle.
MAX_AGE: Final = 500_000_000
_UNIT_TOLERANCE: Final = 0.1
_BODY_FRAMES: Final = ("base_link", "base_footprint", "body")
_WORLD_FRAMES: Final = ("", "map", "odom", "world", "local_origin", "earth")


@dataclass(slots=True)
class Inbound:
    """The vehicle that gets the messages, and what its rows remember.

    Attributes:
        target: The address of the autopilot.
        view: The state of the vehicle.
        now: Unix time in nanoseconds.
        boot: The time at which the bridge began, in nanoseconds: times since boot count from it.
        thrust: The last thrust for attitudes, and the time when it arrived.
    """

    target: Address
    view: VehicleView
    now: int = 0
    boot: int = 0
    thrust: tuple[float, int] | None = None
    counters: dict[str, int] = field(default_factory=dict)

    @property
    def boot_milliseconds(self) -> int:
        """The time since boot for messages."""
        return (self.now - self.boot) // 1_000_000 & 0xFFFFFFFF

    @property
    def microseconds(self) -> int:
        """The time for messages in microseconds, Unix time."""
        return self.now // 1000

    @property
    def addressed(self) -> dict[str, int]:
        """The fields of a message's target."""
        return {"target_system": self.target.system, "target_component": self.target.component}

    def check_age(self, fields: dict[str, Any]) -> None:
        """Raise InvalidArgumentError if the header of a sample is too old; a time of 0 means now."""
        stamp = fields.get("header", {}).get("stamp")
        if not stamp:
            return
        time = stamp["sec"] * 1_000_000_000 + stamp["nanosec"]
        if time and self.now - time > MAX_AGE:
            age = (self.now - time) / 1e9
            raise InvalidArgumentError(
                f"the sample is {age:.1f} s old by its header, at most 0.5 s are allowed: "
                "are the clocks of the machines synchronised?"
            )

    def next_number(self, name: str, limit: int) -> int:
        """Return 0, 1, 2 … below a limit, for a counter of a row."""
        number = self.counters.get(name, -1) + 1
        self.counters[name] = number % limit
        return self.counters[name]

    def is_body_frame(self, fields: dict[str, Any]) -> bool:
        """Return whether the header names the frame of the body; raises InvalidArgumentError for others."""
        name = fields.get("header", {}).get("frame_id", "")
        frames = self.view.frames
        if name == frames.base_link or name in _BODY_FRAMES:
            return True
        if name in (frames.map, frames.odom, frames.earth) or name in _WORLD_FRAMES:
            return False
        raise InvalidArgumentError(f"frame_id must be {frames.map} or {frames.base_link}, got {name!r:.60}")

    def refuse_body_frame(self, fields: dict[str, Any]) -> None:
        """Raise InvalidArgumentError if the header does not name a frame of the world."""
        if self.is_body_frame(fields):
            name = fields["header"]["frame_id"]
            raise InvalidArgumentError(f"frame_id must be {self.view.frames.map}, got {name!r:.60}")


def finite(*values: float) -> None:
    """Raise InvalidArgumentError if a number is not finite."""
    if not all(map(isfinite, values)):
        raise InvalidArgumentError("numbers must be finite")


def vector(fields: dict[str, Any]) -> Vector:
    """Return x, y and z of a Vector3 or Point, which must be finite."""
    found = fields["x"], fields["y"], fields["z"]
    finite(*found)
    return found


def quaternion(fields: dict[str, Any]) -> Quaternion:
    """Return x, y, z and w of a Quaternion, normed; its length must be 1 within a tenth."""
    found = fields["x"], fields["y"], fields["z"], fields["w"]
    finite(*found)
    length = sqrt(sum(value * value for value in found))
    if abs(length - 1.0) > _UNIT_TOLERANCE:
        raise InvalidArgumentError(f"the orientation must be a unit quaternion, got length {length:.3g}")
    return found[0] / length, found[1] / length, found[2] / length, found[3] / length


def location(latitude: float, longitude: float) -> tuple[int, int]:
    """Return latitude and longitude as integers of MAVLink; they must be on Earth."""
    finite(latitude, longitude)
    if abs(latitude) > 90 or abs(longitude) > 180:
        raise InvalidArgumentError(
            f"latitude must be within 90 and longitude within 180 degrees, got {latitude}, {longitude}"
        )
    return round(latitude * 1e7), round(longitude * 1e7)


def yaw_of(q: Quaternion) -> float:
    """Return the yaw of a quaternion (x, y, z, w) in radians, counter-clockwise from east."""
    x, y, z, w = q
    return atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
