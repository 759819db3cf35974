"""Recorded flights: `log:FILE` of a .ulg or a .BIN, whose sensors real firmware gets once more.

The samples are those that the vehicle recorded, each at its time from the beginning of the log; the outputs
of the firmware move nothing. A log has fewer samples than the sensors made, so the last one holds until the
next. ArduPilot takes attitude and position instead of magnetometer, barometer and GPS: it gets the estimate
of the log.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from mavstack.errors import InvalidArgumentError, MavstackError
from mavstack.geodesy import LocalFrame
from mavstack.rotation import LEVEL, from_euler
from mavstack.simulators.atmosphere import STANDARD, Atmosphere
from mavstack.simulators.faults import Faults
from mavstack.simulators.sensors import Fix, Readings
from mavstack.simulators.state import GRAVITY, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.sim.vehicle_types import Home

_FIX_3D: Final = 3
_VELOCITY: Final = ("vel_n_m_s", "vel_e_m_s", "vel_d_m_s")


class Columns(NamedTuple):
    """Columns of a table, and the factor to the unit of the sensor."""

    table: str
    fields: tuple[str, ...]
    factor: float = 1.0


def _axes(table: str, name: str, count: int = 3, factor: float = 1.0) -> Columns:
    return Columns(table, tuple(f"{name}[{axis}]" for axis in range(count)), factor)


#: The columns that may hold each quantity, in order of preference.
COLUMNS: Final[dict[str, tuple[Columns, ...]]] = {
    "rates": (_axes("sensor_combined", "gyro_rad"), Columns("IMU", ("GyrX", "GyrY", "GyrZ"))),
    "force": (_axes("sensor_combined", "accelerometer_m_s2"), Columns("IMU", ("AccX", "AccY", "AccZ"))),
    "field": (
        _axes("vehicle_magnetometer", "magnetometer_ga"),
        _axes("sensor_combined", "magnetometer_ga"),
        Columns("sensor_mag", ("x", "y", "z")),
        Columns("MAG", ("MagX", "MagY", "MagZ"), 1e-3),
    ),
    "pressure": (Columns("vehicle_air_data", ("baro_pressure_pa",), 1e-2), Columns("BARO", ("Press",), 1e-2)),
    "fix": (
        Columns(
            "vehicle_gps_position", ("lat", "lon", "alt", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "fix_type")
        ),
        Columns(
            "vehicle_gps_position",
            ("latitude_deg", "longitude_deg", "altitude_msl_m", *_VELOCITY, "fix_type"),
        ),
        Columns("GPS", ("Lat", "Lng", "Alt", "Spd", "GCrs", "VZ", "Status")),
    ),
    "quaternion": (_axes("vehicle_attitude", "q", 4),),
    "angles": (Columns("ATT", ("Roll", "Pitch", "Yaw"), math.pi / 180.0),),
}


class Course:
    """The samples of one quantity, by seconds from the beginning of the log."""

    def __init__(self, times: Sequence[float], values: Sequence[tuple[float, ...]]) -> None:
        self._times, self._values, self._index = times, values, -1

    def rewind(self) -> None:
        """Begin again."""
        self._index = -1

    def next(self, time: float) -> tuple[float, ...] | None:
        """Return the newest sample up to a time, if it is new."""
        index = self._index
        while index + 1 < len(self._times) and self._times[index + 1] <= time:
            index += 1
        if index == self._index:
            return None
        self._index = index
        return self._values[index]

    @property
    def last(self) -> tuple[float, ...] | None:
        """The sample that was returned last."""
        return self._values[self._index] if self._index >= 0 else None


class LogPhysics:
    """A recorded flight as a body.

    Args:
        file: The path of a .ulg or .BIN.

    Raises:
        InvalidArgumentError: The file cannot be read, or has no accelerometer and gyroscope.
    """

    def __init__(self, file: str) -> None:
        from mavstack.logs import open_log

        if not Path(file).is_file():
            raise InvalidArgumentError(f"the physics log:{file} cannot be made: there is no such file")
        try:
            log = open_log(file)
            courses = {name: _course(log, places) for name, places in COLUMNS.items()}
        except MavstackError as error:
            raise InvalidArgumentError(f"the physics log:{file} cannot be made: {error}") from error
        if courses["rates"] is None or courses["force"] is None:
            raise InvalidArgumentError(
                f"the physics log:{file} cannot be made: it has no accelerometer and gyroscope"
            )
        self.courses = {name: course for name, course in courses.items() if course is not None}
        self._time = 0.0
        self._frame = LocalFrame(0.0, 0.0, 0.0)

    def reset(self, home: Home, heading: float) -> State:
        """Begin the recording again; see `Physics`."""
        self._time = 0.0
        self._frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        for course in self.courses.values():
            course.rewind()
        return self._state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Advance the recording; the actuators move nothing."""
        self._time += dt
        return self._state()

    def sensors(self, home: Home) -> RecordedSensors:
        """Return the recorded sensors."""
        return RecordedSensors(self, home)

    def _state(self) -> State:
        """Return the state as the log estimates it."""
        for name in ("quaternion", "angles"):
            if name in self.courses:
                self.courses[name].next(self._time)
        position = velocity = (0.0, 0.0, 0.0)
        fix = _fix(self.courses["fix"].last) if "fix" in self.courses else None
        if fix is not None and fix.is_valid:
            position = self._frame.to_local(fix.latitude, fix.longitude, fix.altitude)
            velocity = fix.velocity
        rates, force = self.courses["rates"].last, self.courses["force"].last
        return State(
            position,
            velocity,
            self._attitude(),
            (rates[0], rates[1], rates[2]) if rates else (0.0, 0.0, 0.0),
            (force[0], force[1], force[2]) if force else (0.0, 0.0, -GRAVITY),
        )

    def _attitude(self) -> tuple[float, float, float, float]:
        quaternion = self.courses["quaternion"].last if "quaternion" in self.courses else None
        if quaternion is not None:
            w, x, y, z = quaternion
            length = math.hypot(w, x, y, z)
            return (w / length, x / length, y / length, z / length) if length > 0.5 else LEVEL
        angles = self.courses["angles"].last if "angles" in self.courses else None
        return from_euler(angles[0], angles[1], angles[2]) if angles else LEVEL


class RecordedSensors:
    """The sensors of a log; of the faults only `gps-lost` has an effect.

    Args:
        physics: The recording.
        home: The origin of positions.
    """

    def __init__(self, physics: LogPhysics, home: Home) -> None:
        self._courses = physics.courses
        self._frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        self.faults, self.atmosphere = Faults(), Atmosphere()
        self.reset()

    def reset(self) -> None:
        """Begin the recording again."""
        for course in self._courses.values():
            course.rewind()

    def sample(self, state: State, time: float) -> Readings:
        """Return the samples that are due at a time of the recording."""
        self.faults.update(time)
        due = {name: course.next(time) for name, course in self._courses.items() if name in _SENSORS}
        force, rates = self._courses["force"].last, self._courses["rates"].last
        field, pressure, fix = due.get("field"), due.get("pressure"), _fix(due.get("fix"))
        if fix is not None and "gps-lost" in self.faults.active:
            fix = Fix(fix.latitude, fix.longitude, fix.altitude, fix.velocity, is_valid=False)
        return Readings(
            (force[0], force[1], force[2]) if force else state.specific_force,
            (rates[0], rates[1], rates[2]) if rates else state.rates,
            (field[0], field[1], field[2]) if field else None,
            _altitude(pressure[0]) if pressure else None,
            None,
            fix,
        )

    def true_place(self, state: State) -> tuple[float, float, float]:
        """Return latitude, longitude (degrees) and altitude (metres) of the log's estimate."""
        return self._frame.to_global(*state.position)


_SENSORS: Final = frozenset({"rates", "force", "field", "pressure", "fix"})


def _course(log: Log, places: tuple[Columns, ...]) -> Course | None:
    """Return the first of some columns that a log has, of its first instance."""
    for place in places:
        if place.table not in log:
            continue
        table = log[place.table]
        names = table.dtype.names or ()
        if not all(name.partition("[")[0] in names for name in place.fields):
            continue
        if "_instance" in names:
            table = table[table["_instance"] == table["_instance"].min()]
        values = np.column_stack([table.scaled(name) for name in place.fields]) * place.factor
        values = _metric(place, values)
        times = np.asarray(log.seconds_from_start(place.table, table), dtype=float)
        known = np.isfinite(values).all(axis=1)
        return Course(times[known].tolist(), [tuple(row) for row in values[known].tolist()])
    return None


def _metric(place: Columns, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rows of a GPS as latitude, longitude (degrees), altitude (m), velocity (m/s), fix."""
    if place.fields[0] == "lat":
        factors: NDArray[np.float64] = np.array([1e-7, 1e-7, 1e-3, 1.0, 1.0, 1.0, 1.0])
        values *= factors
    if place.table == "GPS":
        course, speed = np.radians(values[:, 4]), values[:, 3].copy()
        values[:, 3], values[:, 4] = speed * np.cos(course), speed * np.sin(course)
    return values


def _fix(row: tuple[float, ...] | None) -> Fix | None:
    if row is None:
        return None
    latitude, longitude, altitude, north, east, down, kind = row
    return Fix(latitude, longitude, altitude, (north, east, down), kind >= _FIX_3D)


def _altitude(pressure: float) -> float:
    """Return the altitude in metres of a pressure in hPa in the standard atmosphere."""
    low, high = -1000.0, 20_000.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if STANDARD.pressure_at(middle) > pressure else (low, middle)
    return 0.5 * (low + high)
