"""The states of a flight: armed or not, and the flight mode, at any time of a log.

Packet logs tell both in the HEARTBEAT of the autopilot, DataFlash logs in ARM (or EV) and MODE, ULogs in
`vehicle_status`. A state lasts until the next record that tells another one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Generic, NamedTuple, TypeVar

import numpy as np

from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.services.modes import mode_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

Value = TypeVar("Value")

_ARMED_FLAG: Final = int(common.MavModeFlag.SAFETY_ARMED)
_HEARTBEAT_FIELDS: Final = ("_system", "_component", "autopilot", "type", "base_mode", "custom_mode")
_NO_AUTOPILOT: Final = int(common.MavAutopilot.INVALID)
#: Ids of DataFlash events.
_EVENT_ARMED, _EVENT_DISARMED = 10, 11
_ULOG_ARMED: Final = 2
#: Flight modes of PX4 by `nav_state` of its topic vehicle_status.
_NAV_STATES: Final = {
    0: "MANUAL", 1: "ALTCTL", 2: "POSCTL", 3: "MISSION", 4: "LOITER", 5: "RTL", 6: "POSITION_SLOW",
    10: "ACRO", 12: "DESCEND", 13: "TERMINATION", 14: "OFFBOARD", 15: "STABILIZED", 17: "TAKEOFF",
    18: "LAND", 19: "FOLLOW_TARGET", 20: "PRECLAND", 21: "ORBIT", 22: "VTOL_TAKEOFF",
    **{22 + number: f"EXTERNAL{number}" for number in range(1, 9)},
}  # fmt: skip


class Span(NamedTuple, Generic[Value]):
    """A state from one time to another, in seconds on the time base of the log."""

    start: float
    end: float
    value: Value

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return self.end - self.start


@dataclass(frozen=True, eq=False)
class States(Generic[Value]):
    """The course of one state.

    Attributes:
        times: Times at which the state was recorded, in ascending order.
        values: The state from each of these times on.
        default: The state before the first time.
    """

    times: NDArray[np.float64]
    values: NDArray[Any]
    default: Value

    def at(self, times: NDArray[np.float64]) -> NDArray[Any]:
        """Return the state at each of some times.

        Args:
            times: Seconds on the time base of the log, in any order.
        """
        if not len(self.times):
            return np.full(len(times), self.default, self.values.dtype)
        positions = np.searchsorted(self.times, times, side="right") - 1
        found: NDArray[Any] = self.values[np.maximum(positions, 0)].copy()
        found[positions < 0] = self.default
        return found

    def spans(self, end: float) -> list[Span[Value]]:
        """Return the stretches of time with one state each, from the first record on.

        Args:
            end: End of the last stretch.
        """
        if not len(self.times):
            return []
        changes = np.flatnonzero(self.values[1:] != self.values[:-1]) + 1
        starts = np.concatenate([[0], changes])
        times = [*self.times[starts].tolist(), max(end, float(self.times[-1]))]
        values = self.values[starts].tolist()
        return [
            Span(first, last, value) for first, last, value in zip(times, times[1:], values, strict=False)
        ]


@dataclass(frozen=True, eq=False)
class FlightStates:
    """The states of one vehicle.

    Attributes:
        armed: True while the motors are armed.
        mode: Name of the flight mode; empty where it is not known.
    """

    armed: States[bool]
    mode: States[str]


def flight_states(log: Log) -> dict[int, FlightStates]:
    """Return the states of each vehicle in a log, by system id.

    Args:
        log: The log, or a view of it.

    Returns:
        The states; a log that a vehicle writes itself has one entry.

    Raises:
        LogError: The log cannot be read.
    """
    if _has(log, "HEARTBEAT", *_HEARTBEAT_FIELDS):
        return _of_heartbeats(log)
    if _has(log, "vehicle_status", "arming_state", "nav_state"):
        return {_own_system(log): _of_vehicle_status(log)}
    return {_own_system(log): _of_dataflash(log)}


def _has(log: Log, table: str, *columns: str) -> bool:
    """Return whether a log has these columns: a log that defines its own tables may lack some."""
    return table in log and log.schema(table).has_numbers(*columns)


def _times(log: Log, name: str, table: MessageTable) -> NDArray[np.float64]:
    """Return the times of rows, NaN where the log holds none, as in a stream without times."""
    try:
        return log.times_of(name, table)
    except LogError:
        return np.full(len(table), np.nan)


def _of_heartbeats(log: Log) -> dict[int, FlightStates]:
    table = log["HEARTBEAT"]
    table = table.where(table["autopilot"] != _NO_AUTOPILOT)
    found = {}
    for system in np.unique(table["_system"]).tolist():
        rows = table.where(table["_system"] == system)
        rows = rows.where(rows["_component"] == rows["_component"].min())
        times = _times(log, "HEARTBEAT", rows)
        autopilot, vehicle = int(rows["autopilot"][-1]), int(rows["type"][-1])

        def name(mode: int, autopilot: int = autopilot, vehicle: int = vehicle) -> str:
            return mode_name(autopilot, vehicle, mode) or str(mode)

        armed = (rows["base_mode"] & _ARMED_FLAG) != 0
        found[system] = FlightStates(
            _states(times, armed, default=False), _modes(times, rows["custom_mode"], name)
        )
    return found


def _of_vehicle_status(log: Log) -> FlightStates:
    table = log["vehicle_status"]
    times = _times(log, "vehicle_status", table)
    armed = np.asarray(table["arming_state"]) == _ULOG_ARMED
    modes = _modes(times, table["nav_state"], lambda mode: _NAV_STATES.get(mode, str(mode)))
    return FlightStates(_states(times, armed, default=False), modes)


def _of_dataflash(log: Log) -> FlightStates:
    armed: States[bool] = States(np.empty(0), np.empty(0, np.bool_), default=False)
    if _has(log, "ARM", "ArmState"):
        table = log["ARM"]
        armed = _states(_times(log, "ARM", table), table["ArmState"] != 0, default=False)
    elif _has(log, "EV", "Id"):
        table = log["EV"].where(np.isin(log["EV"]["Id"], (_EVENT_ARMED, _EVENT_DISARMED)))
        armed = _states(_times(log, "EV", table), table["Id"] == _EVENT_ARMED, default=False)
    modes: States[str] = States(np.empty(0), np.empty(0, object), default="")
    field = next((name for name in ("ModeNum", "Mode") if _has(log, "MODE", name)), None)
    if field is not None:
        table = log["MODE"]
        modes = _modes(_times(log, "MODE", table), np.asarray(table[field]), _dataflash_mode(log))
    return FlightStates(armed, modes)


def _dataflash_mode(log: Log) -> Callable[[int], str]:
    vehicle = common.MavType.__members__.get(log.info.get("vehicle_type", ""), common.MavType.GENERIC)
    return lambda mode: mode_name(common.MavAutopilot.ARDUPILOTMEGA, vehicle, mode) or str(mode)


def _mode_text(number: float, name: Callable[[int], str]) -> str:
    return name(int(number)) if float(number).is_integer() else str(number)


def _own_system(log: Log) -> int:
    return int(log.info.get("system", 0) or 0)


def _states(times: NDArray[np.float64], values: NDArray[Any], *, default: bool) -> States[bool]:
    known = np.isfinite(times)
    order = np.argsort(times[known], kind="stable")
    return States(times[known][order], np.asarray(values)[known][order].astype(np.bool_), default)


def _modes(times: NDArray[np.float64], numbers: NDArray[Any], name: Callable[[int], str]) -> States[str]:
    known = np.isfinite(times)
    order = np.argsort(times[known], kind="stable")
    kept = np.asarray(numbers)[known][order]
    distinct, positions = np.unique(kept, return_inverse=True)
    names = np.array([_mode_text(number, name) for number in distinct.tolist()], dtype=object)
    return States(times[known][order], names[positions] if len(kept) else np.empty(0, object), "")
