"""The status of a flight controller: armed or not, active boxes, reasons not to arm, sensors.

Betaflight sends it as MSP_STATUS_EX, iNav as MSP2_INAV_STATUS. HEARTBEAT, SYS_STATUS and EXTENDED_SYS_STATE
are made of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.arming_reasons import CALIBRATING, ENDED_BY_CHANNELS
from mavstack.bridges.msp.boxes import ACRO, ARM, FAILSAFE
from mavstack.dialects import common
from mavstack.msp.messages.arming import SensorFlag
from mavstack.msp.messages.status import InavStatus, StatusEx

if TYPE_CHECKING:
    from mavstack.bridges.msp.boxes import Boxes
    from mavstack.bridges.msp.telemetry import Power
    from mavstack.msp.messages.base import MspMessage

_FLAG: Final = common.MavModeFlag
_STATE: Final = common.MavState
_SENSOR: Final = common.MavSysStatusSensor
_STANDARD: Final = common.MavStandardMode
_SENSORS: Final = (
    (SensorFlag.GYRO, _SENSOR.SENSOR_3D_GYRO),
    (SensorFlag.ACCELEROMETER, _SENSOR.SENSOR_3D_ACCEL),
    (SensorFlag.MAGNETOMETER, _SENSOR.SENSOR_3D_MAG),
    (SensorFlag.BAROMETER, _SENSOR.SENSOR_ABSOLUTE_PRESSURE),
    (SensorFlag.GPS, _SENSOR.SENSOR_GPS),
    (SensorFlag.RANGEFINDER, _SENSOR.SENSOR_LASER_POSITION),
    (SensorFlag.OPTICAL_FLOW, _SENSOR.SENSOR_OPTICAL_FLOW),
)
#: Reasons not to arm that mean that a sensor or the radio control does not work.
_FAULTS: Final = {
    "NO_GYRO": _SENSOR.SENSOR_3D_GYRO,
    "ACC_CALIBRATION": _SENSOR.SENSOR_3D_ACCEL,
    "ACCELEROMETER_NOT_CALIBRATED": _SENSOR.SENSOR_3D_ACCEL,
    "COMPASS_NOT_CALIBRATED": _SENSOR.SENSOR_3D_MAG,
    "RX_FAILSAFE": _SENSOR.SENSOR_RC_RECEIVER,
    "RC_LINK": _SENSOR.SENSOR_RC_RECEIVER,
}
_MAX_LOAD: Final = 1000


@dataclass(frozen=True, slots=True)
class ControllerStatus:
    """The status of a flight controller.

    Attributes:
        active: Permanent ids of the active boxes.
        reasons: Names of the reasons not to arm.
        sensors: The sensors that it has, `SensorFlag` bits.
        load: Load of its processor in percent.
    """

    active: frozenset[int] = frozenset()
    reasons: tuple[str, ...] = ()
    sensors: int = 0
    load: int = 0

    @classmethod
    def read(cls, message: MspMessage, boxes: Boxes) -> ControllerStatus | None:
        """Return the status in a message; None if it holds none."""
        if not isinstance(message, StatusEx | InavStatus):
            return None
        return cls(
            boxes.active(message.active_modes),
            message.arming_disable_reasons or (),
            int(message.sensors),
            message.load,
        )

    @property
    def armed(self) -> bool:
        """True if the motors run."""
        return ARM in self.active

    @property
    def calibrating(self) -> bool:
        """True while sensors are calibrated."""
        return not CALIBRATING.isdisjoint(self.reasons)

    def failed_checks(self, *, by_channels: bool) -> tuple[str, ...]:
        """Return the reasons not to arm, without those that RC channels end if `by_channels` is set."""
        ended = ENDED_BY_CHANNELS if by_channels else frozenset[str]()
        return () if self.armed else tuple(name for name in self.reasons if name not in ended)


def base_mode(status: ControllerStatus, standard_mode: int, custom_mode: int) -> int:
    """Return `base_mode` of HEARTBEAT."""
    mode = _FLAG.CUSTOM_MODE_ENABLED | _FLAG.MANUAL_INPUT_ENABLED
    if status.armed:
        mode |= _FLAG.SAFETY_ARMED
    if custom_mode != ACRO:
        mode |= _FLAG.STABILIZE_ENABLED
    if standard_mode in (_STANDARD.MISSION, _STANDARD.SAFE_RECOVERY):
        mode |= _FLAG.AUTO_ENABLED | _FLAG.GUIDED_ENABLED
    return int(mode)


def system_status(status: ControllerStatus) -> int:
    """Return `system_status` of HEARTBEAT."""
    if status.armed:
        return _STATE.CRITICAL if FAILSAFE in status.active else _STATE.ACTIVE
    return _STATE.CALIBRATING if status.calibrating else _STATE.STANDBY


def sys_status(status: ControllerStatus, power: Power | None, *, ready: bool) -> common.SysStatus:
    """Return SYS_STATUS; `ready` is the result of the checks before arming."""
    present = _SENSOR.PREARM_CHECK | _SENSOR.SENSOR_RC_RECEIVER
    for flag, sensor in _SENSORS:
        if status.sensors & flag:
            present |= sensor
    if power is not None:
        present |= _SENSOR.SENSOR_BATTERY
    # Without this bit, MAVProxy reports a breach of a geofence that does not exist.
    health = (present if ready else present & ~_SENSOR.PREARM_CHECK) | _SENSOR.GEOFENCE
    for name in status.failed_checks(by_channels=ready):
        health &= ~_FAULTS.get(name, _SENSOR(0))
    return common.SysStatus(
        onboard_control_sensors_present=present,
        onboard_control_sensors_enabled=present,
        onboard_control_sensors_health=health,
        load=min(status.load * 10, _MAX_LOAD),
        voltage_battery=0xFFFF if power is None else min(round(power.voltage * 1000), 0xFFFE),
        current_battery=-1 if power is None else min(round(power.current * 100), 0x7FFF),
        battery_remaining=-1 if power is None else power.remaining,
    )


def extended_state(status: ControllerStatus) -> common.ExtendedSysState:
    """Return EXTENDED_SYS_STATE: ON_GROUND for a disarmed vehicle, UNDEFINED for an armed one."""
    landed = common.MavLandedState
    return common.ExtendedSysState(
        vtol_state=common.MavVtolState.UNDEFINED,
        landed_state=landed.UNDEFINED if status.armed else landed.ON_GROUND,
    )
