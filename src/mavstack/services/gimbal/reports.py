"""The reports of a gimbal: its abilities, who controls it, and where it points.

A gimbal manager takes the requests of ground stations and programs; it controls one gimbal device. The device
is a component of its own, or, with a device id from 1 to 6, a part of the manager's component (guide: gimbal
protocol v2). All angles are in degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, isfinite, isnan, nan, radians
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import Address
from mavstack.services.gimbal.rotation import angles_of, quaternion_of, wrap

if TYPE_CHECKING:
    from typing import Self

#: The device id that means all gimbal devices of a manager.
ALL_DEVICES = 0
#: The largest device id of gimbals that are not MAVLink components.
MAX_ATTACHED_DEVICE = 6
#: The address that means that no component is in control.
NOT_CONTROLLED = Address(0, 0)

_CAPS, _FLAGS = common.GimbalManagerCapFlags, common.GimbalDeviceFlags
DEFAULT_CAPABILITIES = (
    _CAPS.HAS_RETRACT
    | _CAPS.HAS_NEUTRAL
    | _CAPS.HAS_ROLL_AXIS
    | _CAPS.HAS_ROLL_LOCK
    | _CAPS.HAS_PITCH_AXIS
    | _CAPS.HAS_PITCH_LOCK
    | _CAPS.HAS_YAW_AXIS
    | _CAPS.HAS_YAW_FOLLOW
    | _CAPS.HAS_YAW_LOCK
    | _CAPS.SUPPORTS_YAW_IN_EARTH_FRAME
    | _CAPS.CAN_POINT_LOCATION_GLOBAL
)


@dataclass(frozen=True, slots=True)
class GimbalInformation:
    """The abilities of one gimbal (GIMBAL_MANAGER_INFORMATION, and the names of GIMBAL_DEVICE_INFORMATION).

    Attributes:
        device_id: The component id of the gimbal device, or 1 to 6 for one attached to the manager.
        capabilities: GIMBAL_MANAGER_CAP_FLAGS.
        roll_range: The smallest and the largest roll, degrees.
        pitch_range: The smallest and the largest pitch, degrees.
        yaw_range: The smallest and the largest yaw relative to the vehicle, degrees.
        vendor: The maker; "" if unknown.
        model: The model; "" if unknown.
    """

    device_id: int = 1
    capabilities: int = DEFAULT_CAPABILITIES
    roll_range: tuple[float, float] = (-45.0, 45.0)
    pitch_range: tuple[float, float] = (-90.0, 30.0)
    yaw_range: tuple[float, float] = (-180.0, 180.0)
    vendor: str = ""
    model: str = ""

    def can(self, capability: int) -> bool:
        """Return whether the gimbal has all of these GIMBAL_MANAGER_CAP_FLAGS."""
        return self.capabilities & capability == capability

    @classmethod
    def read(cls, message: common.GimbalManagerInformation) -> Self:
        """Return the content of a message."""
        return cls(
            int(message.gimbal_device_id),
            int(message.cap_flags),
            (degrees(message.roll_min), degrees(message.roll_max)),
            (degrees(message.pitch_min), degrees(message.pitch_max)),
            (degrees(message.yaw_min), degrees(message.yaw_max)),
        )

    def to_message(self, milliseconds: int) -> common.GimbalManagerInformation:
        """Return GIMBAL_MANAGER_INFORMATION at a time since boot."""
        return common.GimbalManagerInformation(
            time_boot_ms=milliseconds,
            cap_flags=self.capabilities,
            gimbal_device_id=self.device_id,
            **self._limits(),
        )

    def to_device_message(self, milliseconds: int) -> common.GimbalDeviceInformation:
        """Return GIMBAL_DEVICE_INFORMATION at a time since boot."""
        return common.GimbalDeviceInformation(
            time_boot_ms=milliseconds,
            vendor_name=self.vendor,
            model_name=self.model,
            cap_flags=self.capabilities & 0xFFFF,
            cap_flags2=self.capabilities,
            gimbal_device_id=self.device_id if self.device_id <= MAX_ATTACHED_DEVICE else 0,
            **self._limits(),
        )

    def _limits(self) -> dict[str, Any]:
        ranges = {"roll": self.roll_range, "pitch": self.pitch_range, "yaw": self.yaw_range}
        return {
            f"{axis}_{end}": radians(value)
            for axis, limits in ranges.items()
            for end, value in zip(("min", "max"), limits, strict=True)
        }


@dataclass(frozen=True, slots=True)
class GimbalStatus:
    """The components in control of a gimbal (GIMBAL_MANAGER_STATUS).

    Attributes:
        device_id: The gimbal device.
        primary: The component in primary control; None: no component.
        secondary: The component in secondary control; None: no component.
        flags: GIMBAL_MANAGER_FLAGS.
    """

    device_id: int
    primary: Address | None = None
    secondary: Address | None = None
    flags: int = 0

    def is_controlled_by(self, component: Address) -> bool:
        """Return whether the manager accepts setpoints of a component."""
        return component in (self.primary, self.secondary)

    @classmethod
    def read(cls, message: common.GimbalManagerStatus) -> Self:
        """Return the content of a message."""
        primary = Address(message.primary_control_sysid, message.primary_control_compid)
        secondary = Address(message.secondary_control_sysid, message.secondary_control_compid)
        return cls(
            int(message.gimbal_device_id),
            primary if primary != NOT_CONTROLLED else None,
            secondary if secondary != NOT_CONTROLLED else None,
            int(message.flags),
        )

    def to_message(self, milliseconds: int) -> common.GimbalManagerStatus:
        """Return GIMBAL_MANAGER_STATUS at a time since boot."""
        primary, secondary = self.primary or NOT_CONTROLLED, self.secondary or NOT_CONTROLLED
        return common.GimbalManagerStatus(
            time_boot_ms=milliseconds,
            flags=self.flags,
            gimbal_device_id=self.device_id,
            primary_control_sysid=primary.system,
            primary_control_compid=primary.component,
            secondary_control_sysid=secondary.system,
            secondary_control_compid=secondary.component,
        )


@dataclass(frozen=True, slots=True)
class GimbalAttitude:
    """The attitude of a gimbal (GIMBAL_DEVICE_ATTITUDE_STATUS), in degrees.

    Attributes:
        roll: Roll, degrees.
        pitch: Pitch above the horizon, degrees; -90 points straight down.
        yaw: Yaw to the right of the vehicle's nose, degrees; None if the gimbal reports the other one only.
        heading: Yaw clockwise from north, degrees; None if the gimbal reports the other one only.
        roll_rate: Degrees per second; None if unknown.
        pitch_rate: Degrees per second; None if unknown.
        yaw_rate: Degrees per second, in the frame that the gimbal reports; None if unknown.
        flags: GIMBAL_DEVICE_FLAGS.
        failures: GIMBAL_DEVICE_ERROR_FLAGS; 0 if there is no failure.
    """

    roll: float
    pitch: float
    yaw: float | None = None
    heading: float | None = None
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None
    flags: int = 0
    failures: int = 0

    @property
    def yaw_locked(self) -> bool:
        """True if the gimbal keeps its direction when the vehicle turns."""
        return bool(self.flags & _FLAGS.YAW_LOCK)

    @classmethod
    def read(cls, message: common.GimbalDeviceAttitudeStatus) -> Self | None:
        """Return the content of a message; None if its quaternion is no rotation."""
        angles = angles_of(message.q)
        if angles is None:
            return None
        roll, pitch, angle = angles
        flags = int(message.flags)
        in_earth_frame, names_frame = frame_of(flags)
        delta = degrees(message.delta_yaw) if names_frame and isfinite(message.delta_yaw) else None
        yaw, heading = (None, angle) if in_earth_frame else (angle, None)
        if delta is not None:
            yaw, heading = (wrap(angle - delta), angle) if in_earth_frame else (angle, wrap(angle + delta))
        return cls(
            roll,
            pitch,
            yaw,
            heading,
            _known_degrees(message.angular_velocity_x),
            _known_degrees(message.angular_velocity_y),
            _known_degrees(message.angular_velocity_z),
            flags,
            int(message.failure_flags),
        )

    def to_message(self, milliseconds: int, device_id: int) -> common.GimbalDeviceAttitudeStatus:
        """Return GIMBAL_DEVICE_ATTITUDE_STATUS at a time since boot; yaw is in the vehicle frame if known."""
        earth = self.yaw is None
        angle = (self.heading if earth else self.yaw) or 0.0
        known = self.yaw is not None and self.heading is not None
        frame = _FLAGS.YAW_IN_EARTH_FRAME if earth else _FLAGS.YAW_IN_VEHICLE_FRAME
        return common.GimbalDeviceAttitudeStatus(
            time_boot_ms=milliseconds,
            flags=(self.flags & ~int(_FLAGS.YAW_IN_EARTH_FRAME | _FLAGS.YAW_IN_VEHICLE_FRAME)) | frame,
            q=quaternion_of(self.roll, self.pitch, angle),
            angular_velocity_x=_radians(self.roll_rate),
            angular_velocity_y=_radians(self.pitch_rate),
            angular_velocity_z=_radians(self.yaw_rate),
            failure_flags=self.failures,
            delta_yaw=radians(wrap((self.heading or 0.0) - (self.yaw or 0.0))) if known else nan,
            delta_yaw_velocity=nan,
            gimbal_device_id=device_id if device_id <= MAX_ATTACHED_DEVICE else 0,
        )


def frame_of(flags: int) -> tuple[bool, bool]:
    """Return whether yaw is relative to north, and whether the flags name the frame; older gimbals do not."""
    if flags & _FLAGS.YAW_IN_EARTH_FRAME:
        return True, True
    if flags & _FLAGS.YAW_IN_VEHICLE_FRAME:
        return False, True
    return bool(flags & _FLAGS.YAW_LOCK), False


def _known_degrees(value: float) -> float | None:
    return None if isnan(value) else degrees(value)


def _radians(value: float | None) -> float:
    return nan if value is None else radians(value)
