"""Faults on demand: what goes wrong with a simulated vehicle, live or by a script.

    vehicle.faults.inject("gps off")

    gps off | on              no satellites, and again
    gps spoof NORTH EAST      the receiver is told to be so many metres away from where it is; 0 0 ends it
    compass DEGREES           the compass is wrong by so much
    baro METRES               the barometer is wrong by so much
    motor NUMBER off | on     a motor stands still
    battery sag VOLTS         the battery gives so much less; 0 ends it
    battery PERCENT           the battery holds so much from now on
    radio off | on            the pilot's transmitter is switched off
    link off | on             nothing that is sent arrives, in either direction
    reboot                    the autopilot restarts, wherever the vehicle is

A script has a line a fault: when, in seconds from its beginning; optionally to which vehicle; and the fault.

    30 gps off
    42.5 2: motor 1 off       # system 2; without one, all vehicles
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, radians
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.errors import MavstackError
from mavstack.sim.motion.airframes import AIRFRAMES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mavstack.sim.autopilot.interfaces import Vehicle

_MOTORS = 16
_PERCENT = 100.0
_MOST_SYSTEMS = 255


class FaultSimulation(Protocol):
    """The simulation that a fault script runs in."""

    #: Called before each step with the simulated seconds since the start.
    before_step: list[Callable[[float], None]]

    @property
    def vehicles(self) -> Sequence[Vehicle]:
        """The vehicles."""

    @property
    def elapsed(self) -> float:
        """Simulated seconds since the start."""


class FaultError(MavstackError, ValueError):
    """There is no such fault; the text says which there are."""


class Faults:
    """The faults of one vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        #: What is wrong now, as it was injected, by what it is wrong with: "gps", "gps spoof", "motor 1".
        self.active: dict[str, str] = {}

    def inject(self, text: str) -> None:
        """Let something go wrong, or right again; raises FaultError if it is not understood."""
        Fault.parse(text).inject(self._vehicle)

    def note(self, subject: str, text: str | None) -> None:
        """Remember what is wrong; None if it is right again."""
        if text is None:
            self.active.pop(subject, None)
        else:
            self.active[subject] = text


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault, understood: its kind, its words, and what it does."""

    kind: str
    words: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> Fault:
        """Read `gps off` and the like; raises FaultError."""
        kind, *words = text.lower().split() or [""]
        if kind not in _KINDS:
            raise FaultError(f"there is no fault {text!r}; there are: {', '.join(_KINDS)}")
        fault = cls(kind, tuple(words))
        _KINDS[kind](fault.words)  # raises if its words make no sense
        return fault

    @property
    def text(self) -> str:
        """As it was written."""
        return " ".join((self.kind, *self.words))

    @property
    def what(self) -> str:
        """What it is wrong with: the same for a fault and for its end."""
        if self.kind == "motor":
            return f"motor {float(self.words[0]):g}"
        if self.words[:1] in (("spoof",), ("sag",)):
            return f"{self.kind} {self.words[0]}"
        return self.kind

    def inject(self, vehicle: Vehicle) -> None:
        """Let it happen to a vehicle."""
        wrong = _KINDS[self.kind](self.words)(vehicle)
        vehicle.faults.note(self.what, self.text if wrong else None)


@dataclass(frozen=True, slots=True)
class TimedFault:
    """A fault, when it comes in seconds, and to whom: `system` 0 means every vehicle."""

    time: float
    system: int
    fault: Fault

    @classmethod
    def parse(cls, text: str, time: float = 0.0) -> TimedFault:
        """Read `gps off` or `2: gps off`; raises FaultError."""
        who, colon, rest = text.partition(":")
        try:
            system = int(who) if colon else 0
        except ValueError:
            raise FaultError(f"{text.strip()!r} is not [SYSTEM:] FAULT") from None
        if not 0 <= system <= _MOST_SYSTEMS:
            raise FaultError(f"there is no system {system}")
        return cls(time, system, Fault.parse(rest if colon else text))

    def inject(self, simulation: FaultSimulation) -> None:
        """Let it happen now."""
        for vehicle in simulation.vehicles:
            if self.system in (0, vehicle.address.system):
                self.fault.inject(vehicle)


class FaultScript:
    """Faults at their times."""

    def __init__(self, lines: Iterable[str]) -> None:
        self.faults = sorted(
            (_timed(number, line) for number, line in enumerate(lines, 1) if _bare(line)),
            key=lambda timed: timed.time,
        )
        self._next = 0

    def run_in(
        self, simulation: FaultSimulation, told: Callable[[TimedFault], None] = lambda timed: None
    ) -> None:
        """Inject each fault when its time comes, counted from now; `told` hears of each."""
        begun = simulation.elapsed

        def act(elapsed: float) -> None:
            for timed in self.inject_due(simulation, elapsed - begun):
                told(timed)

        simulation.before_step.append(act)

    def inject_due(self, simulation: FaultSimulation, elapsed: float) -> list[TimedFault]:
        """Inject what is due when so many seconds have passed; gives what was."""
        due = []
        while self._next < len(self.faults) and self.faults[self._next].time <= elapsed:
            due.append(self.faults[self._next])
            self._next += 1
        for timed in due:
            timed.inject(simulation)
        return due


def _bare(line: str) -> str:
    return line.split("#", 1)[0].strip()


def _timed(number: int, line: str) -> TimedFault:
    time, _, rest = _bare(line).partition(" ")
    try:
        seconds = float(time)
    except ValueError:
        raise FaultError(f"line {number}: {line.strip()!r} is not SECONDS [SYSTEM:] FAULT") from None
    if not (isfinite(seconds) and seconds >= 0):
        raise FaultError(f"line {number}: {time} is no time")
    try:
        return TimedFault.parse(rest, seconds)
    except FaultError as error:
        raise FaultError(f"line {number}: {error}") from None


# What each kind does: the words give a function of the vehicle, which gives whether something is wrong now.


def _gps(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    if words[:1] == ("spoof",):
        north, east = _numbers("gps spoof NORTH EAST", words[1:], 2)

        def spoof(vehicle: Vehicle) -> bool:
            vehicle.body.spoof_gps(north, east)
            return (north, east) != (0.0, 0.0)

        return spoof
    off = _is_off("gps off|on|spoof NORTH EAST", words)

    def lose(vehicle: Vehicle) -> bool:
        vehicle.body.fail_gps(off)
        return off

    return lose


def _compass(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    (degrees,) = _numbers("compass DEGREES", words, 1)

    def turn(vehicle: Vehicle) -> bool:
        vehicle.body.offset_compass(radians(degrees))
        return degrees != 0

    return turn


def _baro(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    (metres,) = _numbers("baro METRES", words, 1)

    def drift(vehicle: Vehicle) -> bool:
        vehicle.body.drift_barometer(metres)
        return metres != 0

    return drift


def _motor(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    usage = "motor NUMBER off|on"
    (number,) = _numbers(usage, words[:1], 1)
    off = _is_off(usage, words[1:])
    if number != int(number) or not 1 <= number <= _MOTORS:
        raise FaultError(f"a motor's number is 1 to {_MOTORS}, not {words[0]}")

    def stop(vehicle: Vehicle) -> bool:
        vehicle.body.fail_motor(int(number), off)
        return off and number <= AIRFRAMES[vehicle.type].motors

    return stop


def _battery(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    usage = "battery sag VOLTS, or battery PERCENT"
    if words[:1] == ("sag",):
        (volts,) = _numbers(usage, words[1:], 1)
        if volts < 0:
            raise FaultError(f"it sags by 0 V or more, not by {words[1]}")

        def sag(vehicle: Vehicle) -> bool:
            vehicle.body.sag_battery(volts)
            return volts != 0

        return sag
    (percent,) = _numbers(usage, words, 1)
    if not 0 <= percent <= _PERCENT:
        raise FaultError(f"{words[0]} is no percentage")

    def hold(vehicle: Vehicle) -> bool:
        vehicle.body.recharge(percent / _PERCENT)
        return False

    return hold


def _radio(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    off = _is_off("radio off|on", words)

    def switch(vehicle: Vehicle) -> bool:
        vehicle.autopilot.radio.switch(not off)
        return off and vehicle.autopilot.radio.has_transmitter

    return switch


def _link(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    off = _is_off("link off|on", words)

    def cut(vehicle: Vehicle) -> bool:
        vehicle.cut(off)
        return off

    return cut


def _reboot(words: Sequence[str]) -> Callable[[Vehicle], bool]:
    if words:
        raise FaultError("reboot stands alone")

    def reboot(vehicle: Vehicle) -> bool:
        vehicle.reboot()
        return False

    return reboot


_KINDS: Final[dict[str, Callable[[Sequence[str]], Callable[[Vehicle], bool]]]] = {
    "gps": _gps,
    "compass": _compass,
    "baro": _baro,
    "motor": _motor,
    "battery": _battery,
    "radio": _radio,
    "link": _link,
    "reboot": _reboot,
}


def _numbers(usage: str, words: Sequence[str], count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        numbers = ()
    if len(numbers) != count or not all(map(isfinite, numbers)):
        raise FaultError(f"it is {usage}")
    return numbers


def _is_off(usage: str, words: Sequence[str]) -> bool:
    if tuple(words) not in (("off",), ("on",)):
        raise FaultError(f"it is {usage}")
    return words[0] == "off"
