"""Signals: the quantities of a flight under one name and unit, whatever the format of the log calls them.

`SIGNALS` lists for each signal the columns that may hold it, the best one first. A factor converts the stored
value to the unit of the signal; values that stand for "unknown" are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, inf, isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from mavstack.errors import LogError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

Column: TypeAlias = "NDArray[np.float64]"


class SignalColumn(NamedTuple):
    """A column that holds a signal: the table, the field, and the factor to the unit of the signal.

    A factor of 0 stands for the multiplier of the table's schema: firmware changed the unit of the column.
    Values from `unknown_from` on, in the unit of the signal, stand for "unknown".
    """

    table: str
    field: str
    factor: float = 1.0
    unknown_from: float = inf


@dataclass(frozen=True, slots=True)
class SignalDefinition:
    """A signal: its title, its unit, and the columns that may hold it."""

    title: str
    unit: str
    sources: tuple[SignalColumn, ...]


@dataclass(frozen=True, eq=False)
class Signal:
    """The course of a signal.

    Attributes:
        name: Name of the signal.
        title: Title for people.
        unit: Unit of the values.
        source: Column that it was read from, such as `ATTITUDE.roll`.
        times: Seconds from the beginning of the log, ascending.
        values: The values; none is NaN.
    """

    name: str
    title: str
    unit: str
    source: str
    times: NDArray[np.float64]
    values: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.times)

    def during(self, mask: NDArray[np.bool_]) -> Signal:
        """Return the signal at some of its times.

        Args:
            mask: True for each value to keep.
        """
        return Signal(self.name, self.title, self.unit, self.source, self.times[mask], self.values[mask])


_DEGREES: Final = degrees(1.0)
#: Receivers of u-blox report a dilution of precision of 99.99 as long as they have no fix.
_UNKNOWN_DOP: Final = 99.0
#: ArduPilot logs 255 % for a battery whose capacity it does not know.
_UNKNOWN_PERCENTAGE: Final = 255.0
#: Old ArduPilot reports a load of 2500 % after a loop that took too long: an unsigned number has wrapped.
_UNKNOWN_LOAD: Final = 1000.0


def _define(
    title: str, unit: str, *sources: tuple[str, str] | tuple[str, str, float], unknown_from: float = inf
) -> SignalDefinition:
    found = (SignalColumn(*source)._replace(unknown_from=unknown_from) for source in sources)
    return SignalDefinition(title, unit, tuple(found))


def _motors() -> dict[str, SignalDefinition]:
    return {
        f"output_{number}": _define(
            f"output {number}",
            "us",
            ("SERVO_OUTPUT_RAW", f"servo{number}_raw"),
            ("RCOU", f"C{number}"),
            ("RCOU", f"Chan{number}"),
            ("actuator_outputs", f"output[{number - 1}]"),
        )
        for number in range(1, 9)
    }


SIGNALS: Final[Mapping[str, SignalDefinition]] = MappingProxyType(
    {
        "roll": _define("roll", "deg", ("ATTITUDE", "roll", _DEGREES), ("ATT", "Roll")),
        "pitch": _define("pitch", "deg", ("ATTITUDE", "pitch", _DEGREES), ("ATT", "Pitch")),
        "yaw": _define("yaw", "deg", ("ATTITUDE", "yaw", _DEGREES), ("ATT", "Yaw")),
        "roll_target": _define(
            "roll, target", "deg", ("ATT", "DesRoll"), ("NAV_CONTROLLER_OUTPUT", "nav_roll")
        ),
        "pitch_target": _define(
            "pitch, target", "deg", ("ATT", "DesPitch"), ("NAV_CONTROLLER_OUTPUT", "nav_pitch")
        ),
        "altitude": _define(
            "altitude above home",
            "m",
            ("GLOBAL_POSITION_INT", "relative_alt", 1e-3),
            ("POS", "RelHomeAlt"),
            ("CTUN", "Alt"),
            ("GPS", "RelAlt"),
            ("vehicle_local_position", "z", -1.0),
            ("LOCAL_POSITION_NED", "z", -1.0),
        ),
        "ground_speed": _define(
            "ground speed", "m/s", ("VFR_HUD", "groundspeed"), ("GPS", "Spd"),
            ("vehicle_gps_position", "vel_m_s"),
        ),
        "air_speed": _define(
            "air speed", "m/s", ("VFR_HUD", "airspeed"), ("ARSP", "Airspeed"),
            ("airspeed_validated", "true_airspeed_m_s"),
        ),
        "climb_rate": _define(
            "climb rate", "m/s", ("VFR_HUD", "climb"), ("CTUN", "CRt", 1e-2),
            ("vehicle_local_position", "vz", -1.0)
        ),
        "throttle": _define("throttle", "%", ("VFR_HUD", "throttle"), ("CTUN", "ThO", 100.0)),
        "voltage": _define(
            "battery voltage", "V", ("SYS_STATUS", "voltage_battery", 1e-3), ("BAT", "Volt"),
            ("CURR", "Volt", 0.0),
            ("battery_status", "voltage_v"),
        ),
        "current": _define(
            "battery current", "A", ("SYS_STATUS", "current_battery", 1e-2), ("BAT", "Curr"),
            ("CURR", "Curr", 0.0),
            ("battery_status", "current_a"),
        ),
        "remaining": _define(
            "battery remaining", "%", ("SYS_STATUS", "battery_remaining"), ("BAT", "RemPct"),
            ("battery_status", "remaining", 100.0), unknown_from=_UNKNOWN_PERCENTAGE,
        ),
        "board_voltage": _define(
            "board voltage", "V", ("POWER_STATUS", "Vcc", 1e-3), ("POWR", "Vcc"),
            ("CURR", "Vcc", 0.0),
            ("system_power", "voltage5v_v")
        ),
        "vibration_x": _define("vibration x", "m/s/s", ("VIBRATION", "vibration_x"), ("VIBE", "VibeX")),
        "vibration_y": _define("vibration y", "m/s/s", ("VIBRATION", "vibration_y"), ("VIBE", "VibeY")),
        "vibration_z": _define("vibration z", "m/s/s", ("VIBRATION", "vibration_z"), ("VIBE", "VibeZ")),
        "clipping": _define(
            "clipped samples", "", ("VIBRATION", "clipping_0"), ("VIBE", "Clip0"), ("VIBE", "Clip"),
            ("vehicle_imu_status", "accel_clipping[0]"),
        ),
        "satellites": _define(
            "satellites", "", ("GPS_RAW_INT", "satellites_visible"), ("GPS", "NSats"),
            ("vehicle_gps_position", "satellites_used"), ("sensor_gps", "satellites_used"),
        ),
        "gps_fix": _define(
            "GPS fix", "", ("GPS_RAW_INT", "fix_type"), ("GPS", "Status"),
            ("vehicle_gps_position", "fix_type"),
            ("sensor_gps", "fix_type"),
        ),
        "hdop": _define(
            "HDOP", "", ("GPS_RAW_INT", "eph", 1e-2), ("GPS", "HDop"), ("vehicle_gps_position", "hdop"),
            ("sensor_gps", "hdop"), unknown_from=_UNKNOWN_DOP,
        ),
        "compass_variance": _define(
            "compass test ratio", "", ("EKF_STATUS_REPORT", "compass_variance"), ("XKF4", "SM"),
            ("NKF4", "SM"),
            ("ESTIMATOR_STATUS", "mag_ratio"), ("estimator_status", "mag_test_ratio"),
        ),
        "velocity_variance": _define(
            "velocity test ratio", "", ("EKF_STATUS_REPORT", "velocity_variance"), ("XKF4", "SV"),
            ("NKF4", "SV"),
            ("ESTIMATOR_STATUS", "vel_ratio"), ("estimator_status", "vel_test_ratio"),
        ),
        "position_variance": _define(
            "position test ratio", "", ("EKF_STATUS_REPORT", "pos_horiz_variance"), ("XKF4", "SP"),
            ("NKF4", "SP"),
            ("ESTIMATOR_STATUS", "pos_horiz_ratio"), ("estimator_status", "pos_test_ratio"),
        ),
        "position_resets": _define(
            "resets of the horizontal position", "", ("vehicle_local_position", "xy_reset_counter")
        ),
        "rc_rssi": _define("RC signal", "", ("RC_CHANNELS", "rssi"), ("RC_CHANNELS_RAW", "rssi"),
            ("RSSI", "RXRSSI")),
        "radio_rssi": _define("radio RSSI, local", "", ("RADIO_STATUS", "rssi"), ("RADIO", "rssi"),
            ("RAD", "RSSI")),
        "radio_remrssi": _define(
            "radio RSSI, remote", "", ("RADIO_STATUS", "remrssi"), ("RADIO", "remrssi"), ("RAD", "RemRSSI")
        ),
        "radio_noise": _define("radio noise, local", "", ("RADIO_STATUS", "noise"), ("RADIO", "noise"),
            ("RAD", "Noise")),
        "radio_remnoise": _define(
            "radio noise, remote", "", ("RADIO_STATUS", "remnoise"), ("RADIO", "remnoise"),
            ("RAD", "RemNoise")
        ),
        "cpu_load": _define("processor load", "%", ("SYS_STATUS", "load", 1e-1), ("PM", "Load", 1e-1),
            ("cpuload", "load", 100.0), unknown_from=_UNKNOWN_LOAD),
        **_motors(),
    }
)  # fmt: skip
#: Signals of a telemetry radio, which has its own system id.
_OF_THE_LINK: Final = frozenset({"radio_rssi", "radio_remrssi", "radio_noise", "radio_remnoise"})


#: PX4 logs the attitude as a quaternion (w, x, y, z).
_QUATERNIONS: Final = "vehicle_attitude"


def read_signal(log: Log, name: str, system: int | None = None) -> Signal | None:
    """Read a signal.

    Args:
        log: The log, or a view of it.
        name: Name of the signal, a key of `SIGNALS`.
        system: System id of the vehicle; None for the rows of all.

    Returns:
        The signal from the first column that has values, or None if the log has none of them.

    Raises:
        LogError: The log cannot be read.
    """
    definition = SIGNALS[name]
    if name in _ANGLES and _QUATERNIONS in log and log[_QUATERNIONS].has_number("q[3]"):
        return _angle(log, name, definition)
    for source in definition.sources:
        if source.table not in log or not log[source.table].has_number(source.field):
            continue
        table = _rows(log[source.table], None if name in _OF_THE_LINK else system)
        try:
            times = log.seconds_from_start(source.table, table)
        except LogError:
            continue
        values = _values(table, source)
        known = np.isfinite(values) & np.isfinite(times)
        if known.any():
            order = np.argsort(times[known], kind="stable")
            column = f"{source.table}.{source.field}"
            times, values = times[known][order], values[known][order]
            return Signal(name, definition.title, definition.unit, column, times, values)
    return None


def _roll(w: Column, x: Column, y: Column, z: Column) -> Column:
    return np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))


def _pitch(w: Column, x: Column, y: Column, z: Column) -> Column:
    return np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))


def _yaw(w: Column, x: Column, y: Column, z: Column) -> Column:
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


_ANGLES: Final[Mapping[str, Callable[[Column, Column, Column, Column], Column]]] = MappingProxyType(
    {"roll": _roll, "pitch": _pitch, "yaw": _yaw}
)


def _angle(log: Log, name: str, definition: SignalDefinition) -> Signal | None:
    """Return an angle of the attitude quaternion in degrees."""
    table = _rows(log[_QUATERNIONS], None)
    times = log.seconds_from_start(_QUATERNIONS, table)
    values = np.degrees(_ANGLES[name](*np.asarray(table["q"]).astype(np.float64)[:, :4].T))
    known = np.isfinite(values) & np.isfinite(times)
    if not known.any():
        return None
    column = f"{_QUATERNIONS}.q"
    return Signal(name, definition.title, definition.unit, column, times[known], values[known])


def _rows(table: MessageTable, system: int | None) -> MessageTable:
    """Return the rows of one vehicle, and of the first sensor or port if there are several."""
    names = table.dtype.names or ()
    if system is not None and "_system" in names:
        table = _where(table, table["_system"] == system)
    for name in ("_instance", "port"):
        if name in names and len(table):
            table = _where(table, table[name] == table[name].min())
    return table


def _where(table: MessageTable, rows: NDArray[np.bool_]) -> MessageTable:
    """Return some rows; without a copy if they are all."""
    return table if rows.all() else table.where(rows)


def _values(table: MessageTable, source: SignalColumn) -> NDArray[np.float64]:
    schema = table.schema[source.field.partition("[")[0]]
    # `source.factor` converts the stored value, without the multiplier that `scaled` applies.
    factor = source.factor / schema.multiplier if source.factor else 1.0
    values: NDArray[np.float64] = table.scaled(source.field) * factor
    return np.where(values < source.unknown_from, values, np.nan) if isfinite(source.unknown_from) else values
