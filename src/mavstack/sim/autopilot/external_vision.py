"""Estimates of a companion computer in a vehicle's estimator: ODOMETRY, VISION_…_ESTIMATE, ATT_POS_MOCAP.

The parts that the parameters select replace GPS, barometer or compass. An estimate that contradicts the
vehicle's own is rejected, unless its reset counter changed; after a second of rejections it is taken anyway,
as a reset. When no estimate comes any more, dead reckoning begins. Each firmware decides which messages it
takes (`ardupilot/external_vision.py`, `px4/external_vision.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, isfinite, sin
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Service
from mavstack.sim.motion import Aid

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

KINDS: Final = (
    common.Odometry, common.VisionPositionEstimate, common.VisionSpeedEstimate, common.AttPosMocap,
)  # fmt: skip
#: A position that differs by more metres from the estimate is rejected; after this many seconds of rejections
#: it is accepted.
GATE: Final = 2.0
RESET_AFTER: Final = 1.0


class VisionUse(NamedTuple):
    """The parts of external estimates that the parameters let the estimator use."""

    position: bool = False
    height: bool = False
    velocity: bool = False
    heading: bool = False


@dataclass(frozen=True, slots=True)
class ExternalEstimate:
    """An estimate as it was received: metres and radians in NED; None: not known.

    Attributes:
        time: Seconds of the sender's clock.
        position: North, east, down.
        yaw: The heading.
        has_velocity: True if it has a velocity.
        is_turned: True if its frame does not know north.
        reset_counter: Changes with each jump.
        quality: Percent; 0: not known, -1: failed.
    """

    time: float
    position: tuple[float, float, float] | None
    yaw: float | None
    has_velocity: bool = False
    is_turned: bool = False
    reset_counter: int = 0
    quality: int = 0


class ExternalVision(Service):
    """Receives the estimates of one vehicle.

    Args:
        vehicle: The vehicle.
        use: Returns the parts that the estimator uses.
        timeout: Silence in seconds after which they are no longer used.
        accepts: Returns whether the firmware takes an estimate of a sender.
        changed: Called with True when a position begins to be used, with False when it ends.
    """

    def __init__(
        self,
        vehicle: SimulatedVehicle,
        use: Callable[[], VisionUse],
        *,
        timeout: float,
        accepts: Callable[[Message, ExternalEstimate, Address], bool],
        changed: Callable[[bool], None] = lambda used: None,
    ) -> None:
        super().__init__(vehicle.address)
        self.handles = message_ids(*KINDS)
        self._body, self._use, self._timeout = vehicle.body, use, timeout
        self._accepts, self._changed = accepts, changed
        self._due: float | None = None
        self._reset_counter: int | None = None
        self._rejected_since: float | None = None
        #: True while the estimator uses external positions.
        self.aids_position = False
        #: Time of the last accepted estimate, in Unix seconds; None before the first one.
        self.received_at: float | None = None
        self._body.aid(Aid())

    def receive(self, packet: Packet, now: float) -> bool:
        message = packet.message
        estimate = None if message is None else read_estimate(message)
        if message is None or estimate is None:
            return False
        if not self._accepts(message, estimate, Address(packet.system, packet.component)):
            return False
        self.received_at = now
        use = self._use()
        aid = self._aid(estimate, use)
        jumped = self._reset_counter not in (None, estimate.reset_counter)
        self._reset_counter = estimate.reset_counter
        if aid is not None:
            self._due = now + self._timeout
            if not self._is_rejected(aid, jumped, now):
                self._body.aid(aid, reset=jumped or self._rejected_since is not None)
                self._rejected_since = None
                self._set_used(aid.horizontal is not None)
        return True

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is not None and now >= self._due:
            self._due = self._rejected_since = None
            self._body.aid(Aid())
            self._set_used(False)

    def is_healthy(self, now: float) -> bool:
        """Return whether estimates arrive."""
        return self.received_at is not None and now - self.received_at <= self._timeout

    def _aid(self, estimate: ExternalEstimate, use: VisionUse) -> Aid | None:
        """Return the parts of an estimate that are used; None if none is."""
        here, position = self._body.estimate, estimate.position
        if position is not None and estimate.is_turned and estimate.yaw is not None and not use.heading:
            position = _turned(position, here.yaw - estimate.yaw)
        horizontal = position[:2] if position is not None and use.position else None
        if horizontal is None and use.velocity and estimate.has_velocity:
            # External velocities prevent position drift, so the present position is correct.
            horizontal = here.north, here.east
        down = position[2] if position is not None and use.height else None
        yaw = estimate.yaw if use.heading else None
        aid = Aid(horizontal, down, yaw)
        return None if aid == Aid() else aid

    def _is_rejected(self, aid: Aid, jumped: bool, now: float) -> bool:
        if aid.horizontal is None or jumped or not self.aids_position:
            return False
        here = self._body.estimate
        if hypot(aid.horizontal[0] - here.north, aid.horizontal[1] - here.east) <= GATE:
            self._rejected_since = None
            return False
        self._rejected_since = now if self._rejected_since is None else self._rejected_since
        return now - self._rejected_since < RESET_AFTER

    def _set_used(self, used: bool) -> None:
        if used != self.aids_position:
            self.aids_position = used
            self._changed(used)


def read_estimate(message: Message) -> ExternalEstimate | None:
    """Return the estimate of a message in NED; None if its frame is not one of the world."""
    match message:
        case common.Odometry() as odometry:
            return _read_odometry(odometry)
        case common.VisionPositionEstimate() as vision:
            position = _position(vision.x, vision.y, vision.z)
            yaw = vision.yaw if isfinite(vision.yaw) else None
            return ExternalEstimate(vision.usec / 1e6, position, yaw, reset_counter=vision.reset_counter)
        case common.VisionSpeedEstimate() as speed:
            known = isfinite(speed.x) and isfinite(speed.y)
            return ExternalEstimate(
                speed.usec / 1e6, None, None, has_velocity=known, reset_counter=speed.reset_counter
            )
        case common.AttPosMocap() as mocap:
            position = _position(mocap.x, mocap.y, mocap.z)
            return ExternalEstimate(mocap.time_usec / 1e6, position, _yaw(mocap.q))
    return None


def _read_odometry(message: common.Odometry) -> ExternalEstimate | None:
    frames = common.MavFrame
    position, yaw = _position(message.x, message.y, message.z), _yaw(message.q)
    if message.frame_id == frames.LOCAL_FLU and position is not None:
        position = position[0], -position[1], -position[2]
        yaw = None if yaw is None else -yaw
    elif message.frame_id not in (frames.LOCAL_NED, frames.LOCAL_FRD):
        return None
    return ExternalEstimate(
        message.time_usec / 1e6,
        position,
        yaw,
        isfinite(message.vx) and isfinite(message.vy),
        message.frame_id != frames.LOCAL_NED,
        message.reset_counter,
        message.quality,
    )


def _position(x: float, y: float, z: float) -> tuple[float, float, float] | None:
    return (x, y, z) if isfinite(x) and isfinite(y) and isfinite(z) else None


def _yaw(quaternion: tuple[float, ...]) -> float | None:
    w, x, y, z = quaternion
    if not isfinite(w + x + y + z) or w == x == y == z == 0:
        return None
    return atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _turned(position: tuple[float, float, float], turn: float) -> tuple[float, float, float]:
    north, east, down = position
    return north * cos(turn) - east * sin(turn), north * sin(turn) + east * cos(turn), down
