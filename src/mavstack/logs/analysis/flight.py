"""A flight: one vehicle in a log, with everything that rules and reports ask for, read once."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.logs.analysis.signals import read_signal
from mavstack.logs.flight_states import FlightStates, Span, States, flight_states, unknown_states
from mavstack.logs.own_system import own_system
from mavstack.logs.time_base import unix_seconds
from mavstack.logs.tracks import tracks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.analysis.signals import Signal
    from mavstack.logs.log import Log
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.tracks import Track

_MULTIROTORS: Final = frozenset(
    {
        "QUADROTOR", "HEXAROTOR", "OCTOROTOR", "TRICOPTER", "COAXIAL", "DODECAROTOR", "DECAROTOR",
        "GENERIC_MULTIROTOR",
    }
)  # fmt: skip


_NOT_FLYING: Final = frozenset({"GROUND_ROVER", "SURFACE_BOAT", "SUBMARINE", "ANTENNA_TRACKER"})
#: Metres above home from which a vehicle is in the air, and below which it has landed.
_TAKEN_OFF: Final = 1.5
_LANDED: Final = 0.5


class Flight:
    """One vehicle in a log.

    Args:
        log: The log, or a view of it.
        system: System id of the vehicle; 0 in logs that do not name it.
    """

    def __init__(self, log: Log, system: int) -> None:
        self.log = log
        self.system = system
        self._signals: dict[str, Signal | None] = {}
        self._armed_signals: dict[str, Signal | None] = {}
        self._flying_signals: dict[str, Signal | None] = {}

    def signal(self, name: str) -> Signal | None:
        """Return a signal, or None if the log does not have it; see `SIGNALS`."""
        if name not in self._signals:
            self._signals[name] = read_signal(self.log, name, self.system or None)
        return self._signals[name]

    def armed_signal(self, name: str) -> Signal | None:
        """Return a signal while the vehicle was armed, or None if it has no values then."""
        if name not in self._armed_signals:
            signal = self.signal(name)
            armed = None if signal is None else signal.during(self.is_armed(signal.times))
            self._armed_signals[name] = armed if armed is not None and len(armed) else None
        return self._armed_signals[name]

    def flying_signal(self, name: str) -> Signal | None:
        """Return a signal while the vehicle was in the air, or None if it has no values then."""
        if name not in self._flying_signals:
            signal = self.signal(name)
            flying = None if signal is None else signal.during(self.is_flying(signal.times))
            self._flying_signals[name] = flying if flying is not None and len(flying) else None
        return self._flying_signals[name]

    def armed_steps(self, name: str) -> Signal | None:
        """Return the steps of a signal between values that follow each other while the vehicle is armed.

        A counter that continues while the vehicle is disarmed has no step for that time, whether the log
        holds values of that time or not.

        Args:
            name: Name of the signal, a key of `SIGNALS`.

        Returns:
            The steps with the time of the end of each, or None if there are none.
        """
        signal = self.signal(name)
        if signal is None:
            return None
        starts = np.array([start for start, _ in self.armed_spans])
        flights = np.searchsorted(starts, signal.times, side="left")
        armed = self.is_armed(signal.times)
        steps = replace(signal, times=signal.times[1:], values=np.diff(signal.values))
        steps = steps.during(armed[1:] & armed[:-1] & (flights[1:] == flights[:-1]))
        return steps if len(steps) else None

    def is_armed(self, times: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether the vehicle was armed at each of some times; never, if the log does not hold it.

        Args:
            times: Seconds from the beginning of the log.
        """
        return self.states.armed.at(times + self.start).astype(np.bool_)

    def is_flying(self, times: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether the vehicle was armed and in the air at each of some times.

        A vehicle that does not fly, and one of which the log holds neither its state nor an altitude, is
        taken as being under way while it is armed.

        Args:
            times: Seconds from the beginning of the log.
        """
        airborne = self._airborne
        armed = self.is_armed(times)
        return armed if airborne is None else armed & airborne.at(times + self.start).astype(np.bool_)

    @cached_property
    def _airborne(self) -> States[bool] | None:
        """In the air or not, as the vehicle or its altitude reports; None if that is not known."""
        if self.vehicle_type in _NOT_FLYING:
            return None
        if self.states.airborne.is_known:
            return self.states.airborne
        altitude = self.armed_signal("altitude")
        if altitude is None:
            return None
        airborne = _in_the_air(altitude)
        return States(altitude.times + self.start, airborne, default=bool(airborne[0]))

    @cached_property
    def takeoffs(self) -> int:
        """How often the vehicle rose from the ground while armed."""
        if self._airborne is None:
            return 0
        airborne = self._airborne.values.astype(np.bool_)
        before = np.concatenate([[self._airborne.default], airborne[:-1]])
        return int(np.count_nonzero(airborne & ~before & self.is_armed(self._airborne.times - self.start)))

    @cached_property
    def start(self) -> float:
        """Time of the beginning of the log, in seconds on its time base."""
        span = self.log.time_span
        return 0.0 if span is None else span[0]

    @cached_property
    def duration(self) -> float:
        """Length of the log in seconds."""
        return self.log.duration

    @cached_property
    def states(self) -> FlightStates:
        """Armed or not, and the flight mode."""
        found: Mapping[int, FlightStates] = flight_states(self.log)
        return found.get(self.system, unknown_states())

    @cached_property
    def armed_spans(self) -> list[tuple[float, float]]:
        """Stretches of time in which the vehicle was armed, in seconds from the beginning."""
        spans = self.states.armed.spans(self.start + self.duration, self.start)
        return [(span.start - self.start, span.end - self.start) for span in spans if span.value]

    @cached_property
    def mode_spans(self) -> list[Span[str]]:
        """The flight modes, in seconds from the beginning."""
        start, spans = self.start, self.states.mode.spans(self.start + self.duration)
        return [Span(first - start, last - start, mode) for first, last, mode in spans]

    @cached_property
    def track(self) -> Track | None:
        """The track, or None without positions."""
        return next((track for track in tracks(self.log) if track.system == self.system), None)

    @cached_property
    def texts(self) -> list[tuple[float, LogText]]:
        """The texts of the vehicle with their time in seconds from the beginning."""
        own = [text for text in self.log.texts if text.system in (0, self.system)]
        return list(zip(self._seconds(own), own, strict=True))

    @cached_property
    def parameter_changes(self) -> list[tuple[float, ParameterChange]]:
        """The changes of parameters with their time in seconds from the beginning."""
        own = [change for change in self.log.parameter_changes if change.system in (0, self.system)]
        return list(zip(self._seconds(own), own, strict=True))

    @property
    def vehicle_type(self) -> str:
        """Name of the MAV_TYPE, or empty."""
        vehicle = self.log.vehicles.get(self.system)
        return vehicle.vehicle_type if vehicle is not None else self.log.info.get("vehicle_type", "")

    @property
    def is_multirotor(self) -> bool:
        """True for vehicles that are held up by several rotors."""
        return self.vehicle_type in _MULTIROTORS

    def _seconds(self, records: Sequence[LogText | ParameterChange]) -> list[float]:
        """Return the times of records in seconds from the beginning; NaN where they are not known."""
        if self.log.time_base.kind == "boot":
            boot = [np.nan if record.boot_us is None else record.boot_us for record in records]
            times = np.array(boot, np.float64) / 1e6
        else:
            times = unix_seconds(np.array([record.time for record in records], "M8[us]"))
        seconds: list[float] = (times - self.start).tolist()
        return seconds


def _in_the_air(altitude: Signal) -> NDArray[np.bool_]:
    """Return whether a vehicle was in the air at each value of its altitude above home."""
    values = altitude.values
    # Between the two limits, the previous state continues.
    decided = np.where(values > _TAKEN_OFF, 1, np.where(values < _LANDED, 0, -1))
    last = np.maximum.accumulate(np.where(decided >= 0, np.arange(len(values)), -1))
    return np.asarray((last >= 0) & (decided[last] == 1))


def flights(log: Log) -> list[Flight]:
    """Return the flights of a log, one for each vehicle.

    Args:
        log: The log, or a view of it.

    Returns:
        The flights by ascending system id; a log without a vehicle has one, with the system id 0.
    """
    systems = sorted(log.vehicles) or [own_system(log)]
    return [Flight(log, system) for system in systems]
