"""A scripted quadrotor: it arms, takes off, flies a circle, lands, and begins again.

It is a function of time, not a simulation: `due(now)` gives the messages whose turn it is, and everything in
them follows from where in the script `now` is. `speed` makes the script run faster, not the messages come
more often.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, degrees, pi, radians, sin, sqrt
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.dialects import Message

HOME: Final = (47.397742, 8.545594, 488.0)
HEIGHT: Final = 20.0
RADIUS: Final = 40.0
_METRES_PER_DEGREE: Final = 111_320.0
_CELLS: Final = 4

#: When each part of the script begins, in seconds; the circle begins and ends over home.
ARM: Final = 3.0
TAKEOFF: Final = 5.0
CIRCLE: Final = 15.0
LAND: Final = 75.0
DISARM: Final = 87.0
END: Final = 92.0


@dataclass(frozen=True, slots=True)
class State:
    """Where the vehicle is at one moment, and how it moves: metres and seconds, north, east and up."""

    armed: bool
    mode: ardupilotmega.CopterMode
    north: float
    east: float
    height: float
    climb: float
    speed: float
    course: float
    roll: float
    battery: float

    @property
    def latitude(self) -> float:
        """In degrees."""
        return HOME[0] + self.north / _METRES_PER_DEGREE

    @property
    def longitude(self) -> float:
        """In degrees."""
        return HOME[1] + self.east / (_METRES_PER_DEGREE * cos(radians(HOME[0])))


def state_at(time: float) -> State:
    """The state at `time` seconds of the script, which repeats."""
    time %= END
    angle = 2 * pi * _part(time, CIRCLE, LAND)
    flying = CIRCLE <= time < LAND
    speed = 2 * pi * RADIUS / (LAND - CIRCLE) if flying else 0.0
    up, down = _part(time, TAKEOFF, CIRCLE), _part(time, LAND, DISARM)
    climbing = HEIGHT / (CIRCLE - TAKEOFF) if TAKEOFF <= time < CIRCLE else 0.0
    sinking = HEIGHT / (DISARM - LAND) if LAND <= time < DISARM else 0.0
    return State(
        armed=ARM <= time < DISARM,
        mode=_mode(time),
        north=RADIUS * sin(angle),
        east=RADIUS * (1 - cos(angle)),
        height=HEIGHT * (up - down),
        climb=climbing - sinking,
        speed=speed,
        course=atan2(sin(angle), cos(angle)) % (2 * pi),
        roll=atan2(speed * speed / RADIUS, 9.81),
        battery=1 - 0.3 * time / END,
    )


def _part(time: float, begin: float, end: float) -> float:
    """How much of a part of the script is over, 0 to 1."""
    return min(max((time - begin) / (end - begin), 0.0), 1.0)


def _mode(time: float) -> ardupilotmega.CopterMode:
    modes = ardupilotmega.CopterMode
    if time < TAKEOFF:
        return modes.STABILIZE
    return modes.GUIDED if time < CIRCLE else modes.CIRCLE if time < LAND else modes.LAND


class ScriptedVehicle:
    """What the vehicle says, and when."""

    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed
        self._start: float | None = None
        self._before = -1.0
        self._told = False, ardupilotmega.CopterMode.STABILIZE
        self._due: dict[Callable[[State, int], Message], float] = {}
        self._periods: dict[Callable[[State, int], Message], float] = {
            _heartbeat: 1.0,
            _attitude: 0.05,
            _position: 0.1,
            _vfr_hud: 0.2,
            _gps: 0.2,
            _system: 0.5,
            _battery: 1.0,
        }

    def due(self, now: float) -> Iterator[Message]:
        """The messages to be sent by `now`."""
        if self._start is None:
            self._start = now
            self._due = dict.fromkeys(self._periods, now)
        script = (now - self._start) * self.speed
        state, uptime = state_at(script), int((now - self._start) * 1000)
        for make, period in self._periods.items():
            while self._due[make] <= now:
                self._due[make] += period
                yield make(state, uptime)
        if (state.armed, state.mode) != self._told:
            self._told = state.armed, state.mode
            yield _heartbeat(state, uptime)
        yield from _texts(self._before, script)
        self._before = script


_EVENTS: Final = (
    (0.0, "Mavstack scripted vehicle ready"),
    (ARM, "Arming motors"),
    (TAKEOFF, "Taking off"),
    (CIRCLE, "Flying a circle"),
    (LAND, "Landing"),
    (DISARM, "Disarming motors"),
)


def _texts(before: float, now: float) -> Iterator[Message]:
    """The texts that fall between two moments of the script."""
    for time, text in _EVENTS:
        latest = time + END * ((now - time) // END)
        if before < latest <= now:
            yield common.Statustext(severity=common.MavSeverity.INFO, text=text)


def _heartbeat(state: State, _uptime: int) -> Message:
    mode = common.MavModeFlag.CUSTOM_MODE_ENABLED | common.MavModeFlag.STABILIZE_ENABLED
    status = common.MavState.ACTIVE if state.armed else common.MavState.STANDBY
    return common.Heartbeat(
        type=common.MavType.QUADROTOR,
        autopilot=common.MavAutopilot.ARDUPILOTMEGA,
        base_mode=mode | common.MavModeFlag.SAFETY_ARMED if state.armed else mode,
        custom_mode=state.mode,
        system_status=status,
        mavlink_version=3,
    )


def _attitude(state: State, uptime: int) -> Message:
    wobble = 0.005 * sin(uptime / 300)
    yaw = state.course if state.course <= pi else state.course - 2 * pi
    rate = state.speed / RADIUS
    return common.Attitude(
        time_boot_ms=uptime, roll=state.roll + wobble, pitch=-wobble, yaw=yaw, yawspeed=rate
    )


def _position(state: State, uptime: int) -> Message:
    return common.GlobalPositionInt(
        time_boot_ms=uptime,
        lat=round(state.latitude * 1e7),
        lon=round(state.longitude * 1e7),
        alt=round((HOME[2] + state.height) * 1000),
        relative_alt=round(state.height * 1000),
        vx=round(100 * state.speed * cos(state.course)),
        vy=round(100 * state.speed * sin(state.course)),
        vz=round(-100 * state.climb),
        hdg=round(degrees(state.course) * 100) % 36000,
    )


def _vfr_hud(state: State, _uptime: int) -> Message:
    return common.VfrHud(
        airspeed=state.speed,
        groundspeed=state.speed,
        heading=round(degrees(state.course)) % 360,
        throttle=round(35 + 5 * state.climb) if state.armed else 0,
        alt=HOME[2] + state.height,
        climb=state.climb,
    )


def _gps(state: State, uptime: int) -> Message:
    return common.GpsRawInt(
        time_usec=uptime * 1000,
        fix_type=common.GpsFixType._3D_FIX,  # noqa: SLF001 (an entry's name begins with a digit)
        lat=round(state.latitude * 1e7),
        lon=round(state.longitude * 1e7),
        alt=round((HOME[2] + state.height) * 1000),
        eph=80,
        epv=120,
        vel=round(100 * sqrt(state.speed**2 + state.climb**2)),
        cog=round(degrees(state.course) * 100) % 36000,
        satellites_visible=14,
    )


def _system(state: State, _uptime: int) -> Message:
    kinds = common.MavSysStatusSensor
    sensors = kinds.SENSOR_3D_GYRO | kinds.SENSOR_3D_ACCEL | kinds.SENSOR_GPS
    return common.SysStatus(
        onboard_control_sensors_present=sensors,
        onboard_control_sensors_enabled=sensors,
        onboard_control_sensors_health=sensors,
        load=230,
        voltage_battery=round(1000 * _voltage(state)),
        current_battery=round(100 * _current(state)),
        battery_remaining=round(100 * state.battery),
    )


def _battery(state: State, _uptime: int) -> Message:
    cells = [round(1000 * _voltage(state) / _CELLS)] * _CELLS
    return common.BatteryStatus(
        battery_function=common.MavBatteryFunction.ALL,
        type=common.MavBatteryType.LIPO,
        temperature=2810,
        voltages=[*cells, *[0xFFFF] * (10 - _CELLS)],
        current_battery=round(100 * _current(state)),
        current_consumed=round(5000 * (1 - state.battery)),
        energy_consumed=-1,
        battery_remaining=round(100 * state.battery),
    )


def _voltage(state: State) -> float:
    return _CELLS * (3.3 + 0.9 * state.battery)


def _current(state: State) -> float:
    return 18 + 3 * state.climb if state.armed else 0.6
