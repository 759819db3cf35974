"""An estimate of the pose of a vehicle from outside its autopilot, as the messages that carry it.

ODOMETRY holds everything. ArduPilot takes it in LOCAL_FRD with BODY_FRD alone and aligns it with its own
heading; PX4 takes LOCAL_NED for a frame that knows north, and LOCAL_FRD for one that does not.
VISION_POSITION_ESTIMATE, VISION_SPEED_ESTIMATE and ATT_POS_MOCAP are the older messages for a part of it.
Source: guide, odometry; ArduPilot, GCS_MAVLINK; PX4, MavlinkReceiver.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite, nan
from typing import TYPE_CHECKING, Final, SupportsIndex

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError
from mavstack.rotation import rotate, to_euler
from mavstack.services.external.frames import (
    FULL,
    NORTHERN,
    TRIANGLE,
    UNKNOWN,
    Frame,
    covariance_to_mavlink,
    orientation_to_mavlink,
    to_mavlink,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Quaternion, Vector

_NOTHING: Final = (nan, nan, nan)
_NO_ORIENTATION: Final = (nan, nan, nan, nan)
_NED, _FRD, _BODY = common.MavFrame.LOCAL_NED, common.MavFrame.LOCAL_FRD, common.MavFrame.BODY_FRD
_VISION: Final = common.MavEstimatorType.VISION
_MAX_QUALITY: Final = 100
#: Limits of the length of an orientation, beyond which products of its numbers would become 0 or infinite.
_MIN_LENGTH: Final = 1e-9
_MAX_LENGTH: Final = 1e9


@dataclass(slots=True)
class PoseEstimate:
    """An estimate in the axes of its source; `None` and empty parts are not known.

    Attributes:
        position: Metres in the world frame.
        orientation: The rotation from the body into the world as w, x, y, z.
        velocity: Metres per second in the body frame.
        rotation: Radians per second around the axes of the body frame.
        frame: The world frame.
        body_frame: The body frame.
        pose_covariance: Of position (m²) and orientation (rad²): 36 numbers row by row, or the 21 of the
            upper right triangle; empty, or all 0: not known.
        velocity_covariance: Of velocity and rotation, in the same form.
        reset_counter: Changes with each jump of the estimate, such as a loop closure, 0 to 255.
        quality: Percent, 0: not known, -1: the source has failed.
    """

    position: Vector | None = None
    orientation: Quaternion | None = None
    velocity: Vector | None = None
    rotation: Vector | None = None
    frame: Frame = Frame.ENU
    body_frame: Frame = Frame.FLU
    pose_covariance: Sequence[float] = ()
    velocity_covariance: Sequence[float] = ()
    reset_counter: int = 0
    quality: int = 0

    def __post_init__(self) -> None:
        if type(self.frame) is not Frame or type(self.body_frame) is not Frame:
            self.frame, self.body_frame = as_frame(self.frame), as_frame(self.body_frame)
        if self.body_frame in NORTHERN:
            raise InvalidArgumentError(f"a body frame is FRD, FLU or RDF, got {self.body_frame}")
        if self.position is None and self.orientation is None and self.velocity is None:
            raise InvalidArgumentError("an estimate needs a position, an orientation or a velocity")
        self._check_vectors()
        if len(self.pose_covariance) or len(self.velocity_covariance):
            self._check_covariances()
        if type(self.reset_counter) is not int or type(self.quality) is not int:
            _check_whole("reset_counter", self.reset_counter)
            _check_whole("quality", self.quality)
        if not 0 <= self.reset_counter <= 255 or not -1 <= self.quality <= _MAX_QUALITY:
            raise InvalidArgumentError("reset_counter must be 0 to 255, and quality -1 to 100")

    def _check_vectors(self) -> None:
        if self.position is not None:
            _check_numbers("position", self.position, 3)
        if self.velocity is not None:
            _check_numbers("velocity", self.velocity, 3)
        if self.rotation is not None:
            _check_numbers("rotation", self.rotation, 3)
        if self.orientation is not None:
            _check_numbers("orientation", self.orientation, 4)
            if not _MIN_LENGTH <= (length := hypot(*self.orientation)) <= _MAX_LENGTH:
                raise InvalidArgumentError(
                    f"the length of an orientation must be {_MIN_LENGTH:g} to {_MAX_LENGTH:g}, got {length:g}"
                )

    def _check_covariances(self) -> None:
        for name in ("pose_covariance", "velocity_covariance"):
            if len(getattr(self, name)) not in (0, TRIANGLE, FULL):
                raise InvalidArgumentError(f"{name} needs {FULL} or {TRIANGLE} numbers, or none")

    @property
    def parts(self) -> frozenset[str]:
        """The parts that it has: "position", "yaw", "velocity"."""
        named = {"position": self.position, "yaw": self.orientation, "velocity": self.velocity}
        return frozenset(name for name, value in named.items() if value is not None)

    def to_odometry(self, time_usec: int, *, only_frd: bool = False) -> common.Odometry:
        """Return the ODOMETRY of the estimate.

        Args:
            time_usec: The time of the measurement in microseconds.
            only_frd: Use LOCAL_FRD even for a frame that knows north, as ArduPilot demands.
        """
        frame, body, pose, twist = self.frame, self.body_frame, self.pose_covariance, self.velocity_covariance
        # By position: names of fields cost a third more, at each of 50 messages a second.
        return common.Odometry(
            time_usec,
            _NED if frame in NORTHERN and not only_frd else _FRD,
            _BODY,
            *(_NOTHING if self.position is None else to_mavlink(frame, self.position)),
            _NO_ORIENTATION if self.orientation is None else self._orientation,
            *(_NOTHING if self.velocity is None else to_mavlink(body, self.velocity)),
            *(_NOTHING if self.rotation is None else to_mavlink(body, self.rotation)),
            covariance_to_mavlink(frame, pose) if len(pose) else UNKNOWN,
            covariance_to_mavlink(body, twist) if len(twist) else UNKNOWN,
            self.reset_counter,
            _VISION,
            self.quality,
        )

    def to_vision(self, time_usec: int) -> list[common.VisionPositionEstimate | common.VisionSpeedEstimate]:
        """Return VISION_POSITION_ESTIMATE, and VISION_SPEED_ESTIMATE if there is a velocity."""
        made: list[common.VisionPositionEstimate | common.VisionSpeedEstimate] = []
        if self.position is not None or self.orientation is not None:
            x, y, z = self._position
            roll, pitch, yaw = _NOTHING if self.orientation is None else to_euler(self._orientation)
            covariance = _covariance(self.frame, self.pose_covariance)
            made.append(
                common.VisionPositionEstimate(
                    time_usec, x, y, z, roll, pitch, yaw, covariance, self.reset_counter
                )
            )
        if self.velocity is not None:
            made.append(self._speed(time_usec, self.velocity))
        return made

    def _speed(self, time_usec: int, velocity: Vector) -> common.VisionSpeedEstimate:
        if self.orientation is None:
            raise InvalidArgumentError("a velocity of the body needs its orientation, to be sent as vision")
        x, y, z = rotate(self._orientation, to_mavlink(self.body_frame, velocity))
        return common.VisionSpeedEstimate(time_usec, x, y, z, (nan,) * 9, self.reset_counter)

    def to_mocap(self, time_usec: int) -> common.AttPosMocap:
        """Return ATT_POS_MOCAP."""
        if self.position is None or self.orientation is None:
            raise InvalidArgumentError("motion capture needs a position and an orientation")
        covariance = _covariance(self.frame, self.pose_covariance)
        return common.AttPosMocap(time_usec, self._orientation, *self._position, covariance)

    @property
    def _position(self) -> Vector:
        return _NOTHING if self.position is None else to_mavlink(self.frame, self.position)

    @property
    def _orientation(self) -> Quaternion:
        found = (1.0, 0.0, 0.0, 0.0) if self.orientation is None else self.orientation
        return orientation_to_mavlink(self.frame, self.body_frame, found)


def as_frame(frame: Frame | str) -> Frame:
    """Return a frame by its name; raises InvalidArgumentError."""
    if isinstance(frame, Frame):
        return frame
    try:
        return Frame(str(frame).upper())
    except ValueError:
        names = ", ".join(Frame)
        raise InvalidArgumentError(f"a frame is one of {names}, got {frame!r}") from None


def _covariance(frame: Frame, covariance: Sequence[float]) -> tuple[float, ...]:
    return covariance_to_mavlink(frame, covariance) if len(covariance) else UNKNOWN


def _check_whole(name: str, value: object) -> None:
    if not isinstance(value, SupportsIndex):
        raise InvalidTypeError(f"{name} must be a whole number, got {value!r:.60}")


def _check_numbers(name: str, values: Sequence[float], size: int) -> None:
    # The length of a vector is finite if all its numbers are.
    if len(values) != size or not isfinite(hypot(*values)):
        raise InvalidArgumentError(f"{name} needs {size} finite numbers, got {values}")
