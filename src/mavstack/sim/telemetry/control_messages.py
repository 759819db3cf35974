"""Messages about control: RC channels, targets, actuators and motors.

The attitude target is what the control loops ask for, which the body follows with a lag. The position target
is the point that the autopilot flies to.
"""

from __future__ import annotations

from math import atan2, degrees, hypot, nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.rotation import from_euler
from mavstack.sim.autopilot.behaviours.orbit import Orbit
from mavstack.sim.telemetry.scaling import UINT16_MAX, degrees_e7, int16, uint8, uint16
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.telemetry.view import VehicleView

_MASK = common.PositionTargetTypemask
_ONLY_POSITION = int(
    _MASK.VX_IGNORE
    | _MASK.VY_IGNORE
    | _MASK.VZ_IGNORE
    | _MASK.AX_IGNORE
    | _MASK.AY_IGNORE
    | _MASK.AZ_IGNORE
    | _MASK.YAW_IGNORE
    | _MASK.YAW_RATE_IGNORE
)
_NO_POSITION = int(_MASK.X_IGNORE | _MASK.Y_IGNORE | _MASK.Z_IGNORE)
_CHANNELS_USED = 16
#: Number of motors with ESC telemetry by vehicle type; idle pulse in microseconds, and rpm for each
#: microsecond above it.
_MOTORS = {VehicleType.COPTER: 4, VehicleType.VTOL: 4}
_IDLE_PULSE, _RPM_PER_MICROSECOND = 1000, 14.0


class ControlMessages:
    """Producers of messages about control."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body
        self._autopilot = view.autopilot
        self._motors = _MOTORS.get(view.vehicle.vehicle_type, 0)
        self._escs = 0

    # RC channels and actuators

    def channels(self, now: float) -> Message:
        """Return RC_CHANNELS, all zero without a radio."""
        radio = self._autopilot.radio
        return common.RcChannels(self._view.milliseconds(now), _CHANNELS_USED, *(*radio.channels, radio.rssi))

    def channels_if_received(self, now: float) -> Message | None:
        """Return RC_CHANNELS, only while a radio is received."""
        return self.channels(now) if self._autopilot.radio.present else None

    def raw_channels(self, now: float) -> Message:
        """Return RC_CHANNELS_RAW with the first eight channels."""
        radio = self._autopilot.radio
        return common.RcChannelsRaw(self._view.milliseconds(now), 0, *(*radio.channels[:8], radio.rssi))

    def servos(self, now: float) -> Message:
        """Return SERVO_OUTPUT_RAW."""
        commanded = self._autopilot.payload.servos
        pulses = [
            uint16(commanded.get(number, pulse), 0) for number, pulse in enumerate(self._body.servos, start=1)
        ]
        return common.ServoOutputRaw(self._view.microseconds(now) & 0xFFFFFFFF, 0, *pulses)

    def actuators(self, now: float) -> Message:
        """Return ACTUATOR_OUTPUT_STATUS, outputs scaled to -1 to 1."""
        pulses = tuple(min(max((pulse - 1500.0) / 500.0, -1.0), 1.0) for pulse in self._body.servos)
        return common.ActuatorOutputStatus(
            self._view.microseconds(now), 0xFFFF, (*pulses, *(0.0,) * (32 - len(pulses)))
        )

    def escs(self, now: float) -> Message | None:
        """Return ESC_STATUS of up to four motors; None on types without ESC telemetry."""
        if not self._motors:
            return None
        battery = self._body.battery
        count = self._motors
        share = battery.current / count
        return common.EscStatus(
            0, self._view.microseconds(now), self._rpm(), (battery.voltage,) * 4, (share,) * 4
        )

    def esc_information(self, now: float) -> Message | None:
        """Return ESC_INFO; None on types without ESC telemetry."""
        if not self._motors:
            return None
        self._escs += 1
        celsius = int16(self._body.battery.temperature * 100.0)
        return common.EscInfo(
            index=0,
            time_usec=self._view.microseconds(now),
            counter=self._escs & 0xFFFF,
            count=self._motors,
            connection_type=common.EscConnectionType.DSHOT,
            info=(1 << self._motors) - 1,
            temperature=(celsius,) * 4,
        )

    def esc_telemetry(self, now: float) -> Message | None:
        """Return ESC_TELEMETRY_1_TO_4; None on types without ESC telemetry."""
        if not self._motors:
            return None
        battery = self._body.battery
        self._escs += 1
        count = self._motors
        return ardupilotmega.EscTelemetry1To4(
            temperature=bytes((uint8(battery.temperature),) * 4),
            voltage=(uint16(battery.voltage * 100.0, 0),) * 4,
            current=(uint16(battery.current * 100.0 / count, 0),) * 4,
            totalcurrent=(uint16(battery.consumed / count, 0),) * 4,
            rpm=tuple(min(turns, UINT16_MAX) for turns in self._rpm()),
            count=(self._escs & 0xFFFF,) * 4,
        )

    def _rpm(self) -> tuple[int, ...]:
        """Return the motors' revolutions per minute."""
        return tuple(
            uint16(max(pulse - _IDLE_PULSE, 0) * _RPM_PER_MICROSECOND, 0) for pulse in self._body.servos[:4]
        )

    # Targets

    def attitude_target(self, now: float) -> Message:
        """Return ATTITUDE_TARGET."""
        setpoint, throttle = self._body.attitude_setpoint, self._body.throttle
        attitude = from_euler(setpoint.roll, setpoint.pitch, setpoint.yaw)
        return common.AttitudeTarget(self._view.milliseconds(now), 0, attitude, *setpoint[3:], throttle)

    def local_target(self, now: float) -> Message:
        """Return POSITION_TARGET_LOCAL_NED, without position while there is no target."""
        estimate, target = self._body.estimate, self._autopilot.target
        north, east, down = target if target is not None else (nan, nan, nan)
        return common.PositionTargetLocalNed(
            self._view.milliseconds(now),
            common.MavFrame.LOCAL_NED,
            0 if target is not None else _NO_POSITION,
            north,
            east,
            down,
            estimate.velocity_north,
            estimate.velocity_east,
            estimate.velocity_down,
            estimate.acceleration_north,
            estimate.acceleration_east,
            estimate.acceleration_down,
            estimate.yaw,
            estimate.yaw_rate,
        )

    def local_target_if_guided(self, now: float) -> Message | None:
        """Return POSITION_TARGET_LOCAL_NED, only in guided mode and with a target."""
        autopilot = self._autopilot
        target = autopilot.target
        if target is None or autopilot.mode.number != autopilot.profile.guided:
            return None
        return common.PositionTargetLocalNed(
            self._view.milliseconds(now), common.MavFrame.LOCAL_NED, _ONLY_POSITION, *target
        )

    def global_target(self, now: float) -> Message | None:
        """Return POSITION_TARGET_GLOBAL_INT, while there is a target."""
        return self._global_target(now, common.MavFrame.GLOBAL)

    def global_target_int(self, now: float) -> Message | None:
        """Return POSITION_TARGET_GLOBAL_INT in the frame that PX4 reports."""
        return self._global_target(now, common.MavFrame.GLOBAL_INT)

    def _global_target(self, now: float, frame: int) -> Message | None:
        """Return POSITION_TARGET_GLOBAL_INT in a frame."""
        target = self._autopilot.target
        if target is None:
            return None
        latitude, longitude, altitude = self._body.frame.to_global(*target)
        return common.PositionTargetGlobalInt(
            self._view.milliseconds(now),
            frame,
            _ONLY_POSITION,
            degrees_e7(latitude),
            degrees_e7(longitude),
            altitude,
        )

    def navigation(self, now: float) -> Message:
        """Return NAV_CONTROLLER_OUTPUT, all errors zero while there is no target."""
        estimate, target = self._body.estimate, self._autopilot.target
        north, east, down = target if target is not None else (estimate.north, estimate.east, estimate.down)
        north, east = north - estimate.north, east - estimate.east
        bearing = int16(degrees(atan2(east, north) if north or east else estimate.yaw))
        return common.NavControllerOutput(
            degrees(estimate.roll),
            degrees(estimate.pitch),
            bearing,
            bearing,
            uint16(hypot(north, east)),
            estimate.down - down,
            0.0,
            0.0,
        )

    def navigation_if_steered(self, now: float) -> Message | None:
        """Return NAV_CONTROLLER_OUTPUT as PX4 sends it.

        PX4 sends it only for vehicles that fly forward or drive, and have a target.
        """
        forward = self._body.flies_forward or self._view.vehicle.vehicle_type not in _MOTORS
        return self.navigation(now) if forward and self._autopilot.target is not None else None

    def orbit(self, now: float) -> Message | None:
        """Return ORBIT_EXECUTION_STATUS, while the vehicle orbits."""
        orbit = self._orbit()
        if orbit is None:
            return None
        latitude, longitude, altitude = self._body.frame.to_global(*orbit.centre)
        return common.OrbitExecutionStatus(
            self._view.microseconds(now),
            orbit.radius,
            common.MavFrame.GLOBAL,
            degrees_e7(latitude),
            degrees_e7(longitude),
            altitude,
        )

    def _orbit(self) -> Orbit | None:
        """Return the orbit that is flown."""
        behaviour, command = self._autopilot.behaviour, self._autopilot.guided.command
        if isinstance(behaviour, Orbit):
            return behaviour
        return command if behaviour is not None and isinstance(command, Orbit) else None
