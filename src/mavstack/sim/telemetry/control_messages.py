"""What goes in and comes out of the controllers: sticks, targets, actuators and motors.

The controllers of a simulated vehicle fly by demands of position and speed; so the attitude that was reached
is told as the one that was asked for, and as the target what the autopilot is on its way to.
"""

from __future__ import annotations

from math import atan2, degrees, hypot, nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.autopilot.behaviours.orbit import Orbit
from mavstack.sim.telemetry.scaling import UINT16_MAX, degrees_e7, int16, uint8, uint16
from mavstack.sim.telemetry.view import quaternion
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.telemetry.view import View

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
#: Motors that a speed controller reports about, and what they turn per microsecond of pulse above idle.
_MOTORS = {VehicleType.COPTER: 4, VehicleType.VTOL: 4}
_IDLE, _TURNS = 1000, 14.0


class ControlMessages:
    """Producers of messages about control."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._body = view.body
        self._autopilot = view.autopilot
        self._motors = _MOTORS.get(view.vehicle.type, 0)
        self._escs = 0

    # Sticks and actuators

    def channels(self, now: float) -> Message:
        """RC_CHANNELS, all zero if there is no radio."""
        radio = self._autopilot.radio
        return common.RcChannels(self._view.milliseconds(now), _CHANNELS_USED, *(*radio.channels, radio.rssi))

    def channels_if_heard(self, now: float) -> Message | None:
        """RC_CHANNELS, only while a radio is heard."""
        return self.channels(now) if self._autopilot.radio.present else None

    def raw_channels(self, now: float) -> Message:
        """RC_CHANNELS_RAW: the first eight."""
        radio = self._autopilot.radio
        return common.RcChannelsRaw(self._view.milliseconds(now), 0, *(*radio.channels[:8], radio.rssi))

    def servos(self, now: float) -> Message:
        """SERVO_OUTPUT_RAW."""
        commanded = self._autopilot.payload.servos
        pulses = [
            uint16(commanded.get(number, pulse), 0) for number, pulse in enumerate(self._body.servos, start=1)
        ]
        return common.ServoOutputRaw(self._view.microseconds(now) & 0xFFFFFFFF, 0, *pulses)

    def actuators(self, now: float) -> Message:
        """ACTUATOR_OUTPUT_STATUS: the same as shares, -1 to 1."""
        pulses = tuple(min(max((pulse - 1500.0) / 500.0, -1.0), 1.0) for pulse in self._body.servos)
        return common.ActuatorOutputStatus(
            self._view.microseconds(now), 0xFFFF, (*pulses, *(0.0,) * (32 - len(pulses)))
        )

    def escs(self, now: float) -> Message | None:
        """ESC_STATUS of up to four motors; none for what has no such controllers."""
        if not self._motors:
            return None
        battery = self._body.battery
        count = self._motors
        share = battery.current / count
        return common.EscStatus(
            0, self._view.microseconds(now), self._turns(), (battery.voltage,) * 4, (share,) * 4
        )

    def esc_information(self, now: float) -> Message | None:
        """ESC_INFO of the same."""
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
        """ESC_TELEMETRY_1_TO_4."""
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
            rpm=tuple(min(turns, UINT16_MAX) for turns in self._turns()),
            count=(self._escs & 0xFFFF,) * 4,
        )

    def _turns(self) -> tuple[int, ...]:
        return tuple(uint16(max(pulse - _IDLE, 0) * _TURNS, 0) for pulse in self._body.servos[:4])

    # Targets

    def attitude_target(self, now: float) -> Message:
        """ATTITUDE_TARGET."""
        own = self._body.estimate
        return common.AttitudeTarget(
            self._view.milliseconds(now),
            0,
            quaternion(own.roll, own.pitch, own.yaw),
            own.roll_rate,
            own.pitch_rate,
            own.yaw_rate,
            self._body.throttle,
        )

    def local_target(self, now: float) -> Message:
        """POSITION_TARGET_LOCAL_NED, with no position while there is no target."""
        own, target = self._body.estimate, self._autopilot.target
        north, east, down = target if target is not None else (nan, nan, nan)
        return common.PositionTargetLocalNed(
            self._view.milliseconds(now),
            common.MavFrame.LOCAL_NED,
            0 if target is not None else _NO_POSITION,
            north,
            east,
            down,
            own.velocity_north,
            own.velocity_east,
            own.velocity_down,
            own.acceleration_north,
            own.acceleration_east,
            own.acceleration_down,
            own.yaw,
            own.yaw_rate,
        )

    def local_target_if_guided(self, now: float) -> Message | None:
        """POSITION_TARGET_LOCAL_NED, only in guided mode and with a target."""
        autopilot = self._autopilot
        target = autopilot.target
        if target is None or autopilot.mode.number != autopilot.profile.guided:
            return None
        return common.PositionTargetLocalNed(
            self._view.milliseconds(now), common.MavFrame.LOCAL_NED, _ONLY_POSITION, *target
        )

    def global_target(self, now: float) -> Message | None:
        """POSITION_TARGET_GLOBAL_INT, while there is a target."""
        return self._global_target(now, common.MavFrame.GLOBAL)

    def global_target_int(self, now: float) -> Message | None:
        """POSITION_TARGET_GLOBAL_INT, in the frame that PX4 names."""
        return self._global_target(now, common.MavFrame.GLOBAL_INT)

    def _global_target(self, now: float, frame: int) -> Message | None:
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
        """NAV_CONTROLLER_OUTPUT, all errors zero while there is no target."""
        own, target = self._body.estimate, self._autopilot.target
        north, east, down = target if target is not None else (own.north, own.east, own.down)
        north, east = north - own.north, east - own.east
        bearing = int16(degrees(atan2(east, north) if north or east else own.yaw))
        return common.NavControllerOutput(
            degrees(own.roll),
            degrees(own.pitch),
            bearing,
            bearing,
            uint16(hypot(north, east)),
            own.down - down,
            0.0,
            0.0,
        )

    def navigation_if_steered(self, now: float) -> Message | None:
        """NAV_CONTROLLER_OUTPUT, as PX4 sends it: only for what flies forward or drives, with a target."""
        forward = self._body.flies_forward or self._view.vehicle.type not in _MOTORS
        return self.navigation(now) if forward and self._autopilot.target is not None else None

    def orbit(self, now: float) -> Message | None:
        """ORBIT_EXECUTION_STATUS, while the vehicle orbits."""
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
        behaviour, aim = self._autopilot.behaviour, self._autopilot.guided.aim
        if isinstance(behaviour, Orbit):
            return behaviour
        return aim if behaviour is not None and isinstance(aim, Orbit) else None
