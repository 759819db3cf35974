"""HIGH_LATENCY2 in place of all streams, on vehicles whose link is one of high latency.

ArduPilot has such a link with SERIAL1_PROTOCOL 43, PX4 with MAV_0_MODE 6 (`mavlink start -m iridium`). It
sends no heartbeat and no stream, and answers requests and commands.

- ArduPilot: MAV_CMD_CONTROL_HIGH_LATENCY 1 starts HIGH_LATENCY2 every 5 s, 0 ends it, and other values are
  answered with FAILED; a vehicle without such a link answers ACCEPTED. Source: GCS_Common.cpp,
  handle_control_high_latency (pull request 19882); wiki, common-MAVLink-high-latency.
- PX4: HIGH_LATENCY2 every 67 s (MAV_0_HL_FREQ 0.015 Hz) from the boot on. It ends when a heartbeat of a
  ground station comes over any link, and starts when the ground station is lost; the command, where above
  0.5 means on, holds only until the next status of the vehicle. A vehicle without such a link answers FAILED.
  Source: PX4 1.17, Mavlink::handleStatus and handleCommands, Commander.cpp, mavlink/module.yaml.
"""

from __future__ import annotations

from math import atan2, degrees, hypot
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.failsafes import ground_silence
from mavstack.sim.telemetry.scaling import degrees_e7, int16, percent, uint8, uint16
from mavstack.sim.telemetry.view import VehicleView
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from mavstack.sim.vehicle import SimulatedVehicle

#: Interval of HIGH_LATENCY2 in seconds, by firmware.
INTERVALS: Final = {Firmware.ARDUPILOT: 5.0, Firmware.PX4: 1 / 0.015}
#: By firmware: the parameter that configures a link, and its value for a high-latency link.
_PARAMETERS: Final = {Firmware.ARDUPILOT: ("SERIAL1_PROTOCOL", 43), Firmware.PX4: ("MAV_0_MODE", 6)}
_RESULT, _FLAG = common.MavResult, common.HlFailureFlag
#: Interval in seconds at which PX4 checks whether the ground station is lost.
_STATUS_INTERVAL: Final = 0.5
_UNKNOWN_CUSTOM: Final = -128
_LOW_BATTERY: Final = 0.15
_MAX_INT8: Final = 127


class HighLatency:
    """The link of high latency of one boot."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._view = VehicleView(vehicle)
        self._is_on = False
        self._status_due = 0.0
        name, value = _PARAMETERS[vehicle.firmware]
        #: True if the vehicle has a high-latency link.
        self.is_used = int(vehicle.parameters.get(name, 0)) == value
        vehicle.messages.provide(common.HighLatency2, self.message)
        vehicle.commands.support(common.MavCmd.CONTROL_HIGH_LATENCY, self._control)
        vehicle.services.beacon.enabled = vehicle.modes.enabled = not self.is_used
        if self.is_used:
            vehicle.messages.stop_streams(vehicle.now)
            if vehicle.firmware is Firmware.PX4:
                vehicle.autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Start and end HIGH_LATENCY2 by the presence of a ground station (PX4)."""
        if now < self._status_due:
            return
        self._status_due = now + _STATUS_INTERVAL
        silence = ground_silence(self._vehicle.autopilot)
        lost = silence is None or silence > float(self._vehicle.parameters["COM_DL_LOSS_T"])
        if lost != self._is_on:
            self._switch(lost)

    def _control(self, request: CommandRequest) -> common.MavResult:
        vehicle, wanted = self._vehicle, request.command.param1
        if vehicle.firmware is Firmware.PX4:
            if not self.is_used:
                text = "Control high latency failed! Telemetry unavailable"
                vehicle.send_statustext(text, common.MavSeverity.CRITICAL)
                return _RESULT.FAILED
            is_on = wanted > 0.5
        else:
            if wanted not in (0.0, 1.0):
                return _RESULT.FAILED
            is_on = wanted == 1.0
            text = f"High Latency {'enabled' if is_on else 'disabled'}"
            vehicle.send_statustext(text, common.MavSeverity.NOTICE)
        if self.is_used:
            self._switch(is_on)
        return _RESULT.ACCEPTED

    def _switch(self, is_on: bool) -> None:
        vehicle, self._is_on = self._vehicle, is_on
        interval = INTERVALS[vehicle.firmware] if is_on else 0.0
        vehicle.messages.set_interval(common.HighLatency2, interval, vehicle.now)
        vehicle.touch(vehicle.messages)

    def message(self, now: float) -> common.HighLatency2:
        """Return HIGH_LATENCY2."""
        view, vehicle = self._view, self._vehicle
        autopilot, body, estimate = vehicle.autopilot, vehicle.body, vehicle.body.estimate
        is_px4 = vehicle.firmware is Firmware.PX4
        base_mode = int(autopilot.base_mode)
        heading = round(degrees(estimate.yaw) % 360.0 / 2) % 180
        distance, bearing, height = self._target()
        return common.HighLatency2(
            timestamp=view.milliseconds(now),
            type=vehicle.profile.mav_type(vehicle),
            autopilot=vehicle.firmware.mav_autopilot,
            custom_mode=autopilot.mode.number >> 16 if is_px4 else autopilot.mode.number,
            latitude=degrees_e7(view.position.latitude),
            longitude=degrees_e7(view.position.longitude),
            altitude=int16(view.position.altitude),
            target_altitude=int16(height),
            heading=heading,
            target_heading=round(bearing / 2) % 180,
            target_distance=uint16(distance / 10),
            throttle=uint8(min(max(body.throttle, 0.0), 1.0) * 100),
            airspeed=uint8(min(body.airspeed * 5, 255)),
            groundspeed=uint8(min(hypot(estimate.velocity_north, estimate.velocity_east) * 5, 255)),
            eph=uint8(min(view.sensors.gps_eph * 10, 255)),
            epv=uint8(min(view.sensors.gps_epv * 10, 255)),
            temperature_air=int(min(max(view.sensors.temperature, -127), _MAX_INT8)),
            climb_rate=int(min(max(-estimate.velocity_down * 10, -_MAX_INT8), _MAX_INT8)),
            battery=percent(body.battery.remaining),
            wp_num=vehicle.mission.current & 0xFFFF,
            failure_flags=self._failures(),
            custom0=_UNKNOWN_CUSTOM if is_px4 else base_mode - 256 * (base_mode > _MAX_INT8),
            custom1=_UNKNOWN_CUSTOM if is_px4 else 0,
            custom2=_UNKNOWN_CUSTOM if is_px4 else 0,
        )

    def _target(self) -> tuple[float, float, float]:
        """Return distance (m), bearing (degrees) and altitude (m) of the target."""
        estimate, target = self._vehicle.body.estimate, self._vehicle.autopilot.target
        if target is None:
            return 0.0, 0.0, self._view.position.altitude
        north, east = target[0] - estimate.north, target[1] - estimate.east
        altitude = self._view.position.altitude + estimate.down - target[2]
        return hypot(north, east), degrees(atan2(east, north)) % 360.0, altitude

    def _failures(self) -> int:
        view, failsafes = self._view, " ".join(self._vehicle.autopilot.failsafes)
        flags = _FLAG(0)
        if not view.health.horizontal:
            flags |= _FLAG.GPS | _FLAG.ESTIMATOR
        if view.body.battery.remaining < _LOW_BATTERY:
            flags |= _FLAG.BATTERY
        if "radio" in failsafes:
            flags |= _FLAG.RC_RECEIVER
        if "fence" in failsafes:
            flags |= _FLAG.GEOFENCE
        return int(flags)
