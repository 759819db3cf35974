"""The answers of iNav alone: status, analog values, navigation, waypoints, safe homes, settings by name."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Final

from mavstack.msp.commands import InavCommand
from mavstack.msp.commands import MspCommand as Command
from mavstack.msp.messages import config, pid, rc
from mavstack.msp.messages.arming import InavArmingFlag, SensorFlag
from mavstack.msp.messages.navigation import (
    GetSafehome,
    GetWp,
    NavStatus,
    Safehome,
    SetSafehome,
    SetWp,
    WaypointAction,
    Wp,
    WpInfo,
)
from mavstack.msp.messages.pid import InavPid, Pid, PidNames
from mavstack.msp.messages.rc import InavRateProfile, RcTuning
from mavstack.msp.messages.sensors import AirSpeed
from mavstack.msp.messages.status import HardwareStatus, InavStatus, SensorStatus, Status, StatusEx
from mavstack.sim.msp import telemetry
from mavstack.sim.msp.answers import common_handlers, setting_handlers
from mavstack.sim.msp.inav_settings_by_name import setting_by_name_handlers
from mavstack.sim.msp.system import RefusedError
from mavstack.sim.msp.waypoints import MAX_WAYPOINTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.inav_navigation import InavNavigation
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.system import System

    Handler = Callable[[bytes, MspPort], bytes]

#: Number of safe homes.
SAFEHOMES: Final = 8
SENSORS: Final = (
    SensorFlag.ACCELEROMETER
    | SensorFlag.BAROMETER
    | SensorFlag.MAGNETOMETER
    | SensorFlag.GPS
    | SensorFlag.GYRO
)
PID_NAMES: Final = ("ROLL", "PITCH", "YAW", "ALT", "Pos", "PosR", "NavR", "LEVEL", "MAG", "VEL")
_CYCLE_TIME: Final = 500e-6
_LOAD: Final = 12
_MODE_WORDS: Final = 2


def make_handlers(system: System, navigator: InavNavigation) -> Mapping[int, Handler]:
    """Return the handlers of iNav by command.

    Args:
        system: The firmware.
        navigator: Its navigation.
    """
    own = InavAnswers(system, navigator)
    handlers = common_handlers(system)
    handlers |= setting_handlers(system, "INAV")
    for message, produce in own.producers():
        handlers[message] = own.handler(produce)
    return handlers | own.waypoint_handlers() | setting_by_name_handlers(system)


class InavAnswers:
    """The handlers that need the navigation or the status of iNav."""

    def __init__(self, system: System, navigator: InavNavigation) -> None:
        self._system, self._navigator = system, navigator
        self._safehomes = [Safehome(index, False, 0.0, 0.0) for index in range(SAFEHOMES)]

    def handler(self, produce: Callable[[], MspMessage]) -> Handler:
        """Return a handler that sends the message that a function makes."""
        return lambda *_: self._system.encode(produce())

    def producers(self) -> list[tuple[int, Callable[[], MspMessage]]]:
        """Return the functions that make messages, by command."""
        system = self._system
        return [
            (Command.MSP_STATUS, self._status),
            (Command.MSP_STATUS_EX, self._status_ex),
            (Command.MSP2_INAV_STATUS, self._inav_status),
            (Command.MSP_SENSOR_STATUS, self._sensor_status),
            (Command.MSP2_INAV_ANALOG, lambda: telemetry.inav_analog(system)),
            (Command.MSP2_INAV_AIR_SPEED, lambda: AirSpeed(system.body.airspeed)),
            (Command.MSP_NAV_STATUS, self._nav_status),
            (Command.MSP_WP_GETINFO, self._waypoint_info),
            (Command.MSP_PIDNAMES, lambda: PidNames(PID_NAMES)),
            (Command.MSP_PID, self._pid),
            (Command.MSP_RC_TUNING, self._rc_tuning),
            (InavCommand.MSP_RTC, lambda: config.InavRtc(int(system.now), int(system.now % 1 * 1000))),
        ]

    # --- status

    def _flags(self) -> int:
        return self._system.boxes.flags(self._system.active_boxes())

    def _arming_flags(self) -> InavArmingFlag:
        arming = self._system.arming
        return InavArmingFlag(arming.flags | arming.armed << 2 | arming.was_ever_armed << 3)

    def _status(self) -> Status:
        return Status(_CYCLE_TIME, 0, SENSORS, self._flags() & 0xFFFF_FFFF, self._system.settings.pid_profile)

    def _status_ex(self) -> StatusEx:
        flags, profile = self._flags() & 0xFFFF_FFFF, self._system.settings.pid_profile
        arming = InavArmingFlag(self._arming_flags() & 0xFFFF)
        return StatusEx(
            _CYCLE_TIME,
            0,
            SENSORS,
            flags,
            profile,
            _LOAD,
            arming_flags=arming,
            accelerometer_calibrated_axes=0x3F,
        )

    def _inav_status(self) -> InavStatus:
        flags = self._flags()
        words = tuple(flags >> 32 * word & 0xFFFF_FFFF for word in range(_MODE_WORDS))
        profile = self._system.settings.pid_profile
        return InavStatus(_CYCLE_TIME, 0, SENSORS, _LOAD, profile, self._arming_flags(), words, 0)

    def _sensor_status(self) -> SensorStatus:
        ok, none = HardwareStatus.OK, HardwareStatus.NONE
        return SensorStatus(True, ok, ok, ok, ok, ok, none, none, none)

    # --- navigation

    def _nav_status(self) -> NavStatus:
        navigator = self._navigator
        number = navigator.active_waypoint
        action = navigator.mission.read(number).action if number else WaypointAction.NONE
        heading = telemetry.attitude(self._system).heading
        return NavStatus(navigator.mode, navigator.state, action, number, navigator.error, heading)

    def _waypoint_info(self) -> WpInfo:
        mission = self._navigator.mission
        return WpInfo(0, MAX_WAYPOINTS, mission.is_valid, len(mission.waypoints))

    def waypoint_handlers(self) -> dict[int, Handler]:
        """Return the handlers of waypoints and safe homes."""
        system = self._system
        return {
            Command.MSP_WP: lambda payload, _: self._read_waypoint(payload),
            Command.MSP_SET_WP: system.action(lambda payload, _: self._write_waypoint(payload)),
            Command.MSP_WP_MISSION_LOAD: system.action(lambda *_: self._load_mission()),
            Command.MSP_WP_MISSION_SAVE: system.action(lambda *_: self._save_mission()),
            Command.MSP2_INAV_SAFEHOME: lambda payload, _: self._read_safehome(payload),
            Command.MSP2_INAV_SET_SAFEHOME: system.action(lambda payload, _: self._write_safehome(payload)),
            Command.MSP2_SET_PID: system.writer(InavPid, pid.SetInavPid),
            Command.MSP_SET_PID: system.action(lambda payload, _: self._set_pid(payload)),
            Command.MSP_SET_RC_TUNING: system.action(lambda payload, _: self._set_rc_tuning(payload)),
            InavCommand.MSP_SET_RTC: system.action(lambda *_: None),
        }

    def _read_waypoint(self, payload: bytes) -> bytes:
        number = GetWp.decode(payload).index
        place = self._navigator.special_position(number)
        waypoint = self._navigator.mission.read(number)
        if place is not None:
            latitude, longitude, altitude = place
            waypoint = dataclasses.replace(
                waypoint, index=number, latitude=latitude, longitude=longitude, altitude=altitude
            )
        return self._system.encode(waypoint)

    def _write_waypoint(self, payload: bytes) -> None:
        waypoint = Wp.from_message(SetWp.decode(payload, self._system.info))
        if not self._navigator.write(waypoint):
            raise RefusedError

    def _load_mission(self) -> None:
        if self._system.arming.armed or not self._navigator.mission.load():
            raise RefusedError

    def _save_mission(self) -> None:
        if self._system.arming.armed or not self._navigator.mission.save():
            raise RefusedError
        self._system.save()

    def _read_safehome(self, payload: bytes) -> bytes:
        index = GetSafehome.decode(payload).index
        if index >= SAFEHOMES:
            raise RefusedError
        return self._system.encode(self._safehomes[index])

    def _write_safehome(self, payload: bytes) -> None:
        written = SetSafehome.decode(payload)
        if written.index >= SAFEHOMES:
            raise RefusedError
        self._safehomes[written.index] = Safehome.from_message(written)

    # --- settings in the message formats of other firmwares

    def _pid(self) -> Pid:
        gains = self._system.settings.get(InavPid).controllers
        return Pid(tuple(pid.Gains(each.p, each.i, each.d) for each in gains))

    def _set_pid(self, payload: bytes) -> None:
        written = pid.SetPid.decode(payload).controllers
        present = list(self._system.settings.get(InavPid).controllers)
        for index, gains in enumerate(written[: len(present)]):
            present[index] = dataclasses.replace(present[index], p=gains.p, i=gains.i, d=gains.d)
        self._system.settings.put(InavPid(tuple(present)))

    def _rc_tuning(self) -> RcTuning:
        return RcTuning.from_message(self._system.settings.get(InavRateProfile), rc_rate=100)

    def _set_rc_tuning(self, payload: bytes) -> None:
        self._system.settings.update(InavRateProfile, rc.SetRcTuning.decode(payload, self._system.info))
