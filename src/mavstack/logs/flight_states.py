"""The states of a flight: armed or not, in the air or not, and the flight mode, at any time of a log.

Packet logs hold them in the HEARTBEAT of the autopilot and EXTENDED_SYS_STATE, DataFlash logs in ARM, EV,
STAT and MODE, ULogs in `vehicle_status` and `vehicle_land_detected`. A Blackbox records while the vehicle is
armed. A state lasts until the next record with another one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Generic, NamedTuple, TypeVar

import numpy as np

from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs.own_system import own_system
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
#: Ids of the DataFlash events at which the state begins and ends.
_ARMED_EVENTS: Final = (10, 11)
_AIRBORNE_EVENTS: Final = (28, 18)
_ULOG_ARMED: Final = 2
#: Column of DataFlash tables without a time: the boot time of the previous record.
_NEIGHBOUR_TIME: Final = "_boot_us"
_LANDED_STATES: Final = (common.MavLandedState.ON_GROUND, common.MavLandedState.UNDEFINED)
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

    @property
    def is_known(self) -> bool:
        """True if the log holds the state at any time."""
        return len(self.times) > 0

    def spans(self, end: float, start: float | None = None) -> list[Span[Value]]:
        """Return the stretches of time with one state each.

        Args:
            end: End of the last stretch.
            start: Begin of the stretch with the default before the first record; None begins with the record.
        """
        if not len(self.times):
            return []
        if start is not None and start < self.times[0]:
            earlier = Span(start, float(self.times[0]), self.default)
            return [earlier, *self.spans(end)]
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
        armed: True while the motors are armed; without times if the log does not hold it.
        mode: Name of the flight mode; empty where it is not known.
        airborne: True while the vehicle itself reports that it is not landed; without times if it does not.
    """

    armed: States[bool]
    mode: States[str]
    airborne: States[bool]


def unknown_states() -> FlightStates:
    """Return the states of a vehicle of which a log holds none."""
    return FlightStates(_unknown(), States(np.empty(0), np.empty(0, object), ""), _unknown())


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
    if log.format == "blackbox":
        return {own_system(log): _of_blackbox(log)}
    is_ulog = _has(log, "vehicle_status", "arming_state") or _has(log, "actuator_armed", "armed")
    return {own_system(log): _of_ulog(log) if is_ulog else _of_dataflash(log)}


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
            _states(times, armed, default=False),
            _modes(times, rows["custom_mode"], name),
            _landed_states(log, system),
        )
    return found


def _landed_states(log: Log, system: int) -> States[bool]:
    """Return the states in EXTENDED_SYS_STATE."""
    if not _has(log, "EXTENDED_SYS_STATE", "_system", "landed_state"):
        return _unknown()
    table = log["EXTENDED_SYS_STATE"]
    known = table["landed_state"] != common.MavLandedState.UNDEFINED
    table = table.where((table["_system"] == system) & known)
    airborne = ~np.isin(table["landed_state"], _LANDED_STATES)
    return _from_the_first(_states(_times(log, "EXTENDED_SYS_STATE", table), airborne, default=False))


def _of_blackbox(log: Log) -> FlightStates:
    start = (0.0,) if log.time_span is None else log.time_span
    armed = States(np.array(start[:1]), np.ones(1, np.bool_), default=False)
    return replace(unknown_states(), armed=armed)


def _of_ulog(log: Log) -> FlightStates:
    armed = _flags(log, "vehicle_status", "arming_state", lambda state: state == _ULOG_ARMED)
    if not armed.is_known:
        armed = _flags(log, "actuator_armed", "armed", lambda value: value != 0)
    modes = unknown_states().mode
    if _has(log, "vehicle_status", "nav_state"):
        table = log["vehicle_status"]
        times = _times(log, "vehicle_status", table)
        modes = _modes(times, table["nav_state"], lambda mode: _NAV_STATES.get(mode, str(mode)))
    airborne = _from_the_first(_flags(log, "vehicle_land_detected", "landed", lambda value: value == 0))
    return FlightStates(armed, modes, airborne)


def _flags(log: Log, name: str, field: str, holds: Callable[[NDArray[Any]], NDArray[Any]]) -> States[bool]:
    """Return the states in a column; unknown if the log lacks it."""
    if not _has(log, name, field):
        return _unknown()
    table = log[name]
    return _states(_times(log, name, table), holds(np.asarray(table[field])), default=False)


def _events(log: Log, ids: tuple[int, int]) -> States[bool]:
    """Return a state that events begin and end. Before the first event it was the other one."""
    if not _has(log, "EV", "Id"):
        return _unknown()
    table = log["EV"].where(np.isin(log["EV"]["Id"], ids))
    times, begins = _times(log, "EV", table), table["Id"] == ids[0]
    if _NEIGHBOUR_TIME in (table.dtype.names or ()):
        times[begins] = _times_after(log, times[begins])
    states = _states(times, begins, default=False)
    return replace(states, default=len(states.values) > 0 and not states.values[0])


def _times_after(log: Log, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the time of the first record after each time.

    A log that is written while the vehicle is armed continues with the event that begins the next flight; the
    record before that event is of the flight before.
    """
    timed = [name for name in log if not log.schema(name).has_numbers(_NEIGHBOUR_TIME)]
    if not timed:
        return times
    busiest = max(timed, key=log.counts.__getitem__)
    recorded = np.sort(_times(log, busiest, log[busiest]))
    recorded = recorded[np.isfinite(recorded)]
    after = np.searchsorted(recorded, times, side="right")
    return np.where(after < len(recorded), np.append(recorded, np.nan)[after], times)


def _of_dataflash(log: Log) -> FlightStates:
    armed = _flags(log, "ARM", "ArmState", lambda state: state != 0)
    armed = replace(armed, default=not armed.values[0]) if armed.is_known else _events(log, _ARMED_EVENTS)
    if not armed.is_known:
        armed = _flags(log, "STAT", "Armed", lambda value: value != 0)
    airborne = _events(log, _AIRBORNE_EVENTS)
    if not airborne.is_known:
        airborne = _from_the_first(_flags(log, "STAT", "isFlying", lambda value: value != 0))
    modes: States[str] = States(np.empty(0), np.empty(0, object), default="")
    field = next((name for name in ("ModeNum", "Mode") if _has(log, "MODE", name)), None)
    if field is not None:
        table = log["MODE"]
        modes = _modes(_times(log, "MODE", table), np.asarray(table[field]), _dataflash_mode(log))
    return FlightStates(armed, modes, airborne)


def _from_the_first(states: States[bool]) -> States[bool]:
    """Return states that were the first one before it too: a stream began with the log, not with a change."""
    return replace(states, default=bool(len(states.values) and states.values[0]))


def _unknown() -> States[bool]:
    return States(np.empty(0), np.empty(0, np.bool_), default=False)


def _dataflash_mode(log: Log) -> Callable[[int], str]:
    vehicle = common.MavType.__members__.get(log.info.get("vehicle_type", ""), common.MavType.GENERIC)
    return lambda mode: mode_name(common.MavAutopilot.ARDUPILOTMEGA, vehicle, mode) or str(mode)


def _mode_text(number: float, name: Callable[[int], str]) -> str:
    return name(int(number)) if float(number).is_integer() else str(number)


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
