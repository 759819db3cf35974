"""Faults of simulated vehicles, injected live or by a script.

    vehicle.faults.inject("gps off")

    gps off | on              loss of all satellites
    gps spoof NORTH EAST      GPS position shifted by metres; 0 0 ends it
    compass DEGREES           compass error in degrees
    baro METRES               barometer error in metres
    motor NUMBER off | on     motor failure
    battery sag VOLTS         voltage drop in volts; 0 ends it
    battery PERCENT           remaining charge in percent
    radio off | on            loss of the pilot's transmitter
    link off | on             loss of all links, in both directions
    reboot                    restart of the autopilot
    power cycle               restart that loses unsaved parameters

A script has one fault per line: the time in seconds from the start, optionally the system id, and the fault.

    30 gps off
    42.5 2: motor 1 off       # system 2; without one, all vehicles
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from math import isfinite, radians
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.errors import InvalidArgumentError
from mavstack.sim.motion.airframes import AIRFRAMES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mavstack.services import Address
    from mavstack.sim.motion import Body
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle_types import VehicleType

_LOG = logging.getLogger("mavstack.sim")
_MOTORS = 16
_PERCENT = 100.0
_MAX_SYSTEMS = 255


class FaultTarget(Protocol):
    """A vehicle, as faults see it."""

    body: Body
    vehicle_type: VehicleType
    address: Address
    faults: Faults

    def cut(self, off: bool) -> None:
        """Cut or restore all links."""

    def reboot(self) -> None:
        """Restart the autopilot."""

    def power_cycle(self) -> None:
        """Restart the autopilot without its unsaved parameters."""

    def switch_transmitter(self, on: bool) -> bool:
        """Switch the pilot's transmitter on or off; returns whether the pilot has lost it."""


class FaultError(InvalidArgumentError):
    """A fault is unknown or malformed; the text lists the faults or the usage."""


class Faults:
    """The faults of one vehicle."""

    def __init__(self, vehicle: FaultTarget) -> None:
        self._vehicle = vehicle
        #: Texts of the active faults, by subject ("gps", "gps spoof", "motor 1").
        self.active: dict[str, str] = {}

    def inject(self, text: str) -> None:
        """Inject or end a fault.

        Args:
            text: The fault, such as `gps off`.

        Raises:
            FaultError: The fault is unknown or malformed.
        """
        Fault.parse(text).inject(self._vehicle)

    def note(self, subject: str, text: str | None) -> None:
        """Record the fault of a subject; None records its end."""
        if text is None:
            self.active.pop(subject, None)
        else:
            self.active[subject] = text


@dataclass(frozen=True, slots=True)
class Fault:
    """A parsed fault: its kind and its words."""

    kind: str
    words: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> Fault:
        """Parse a fault such as `gps off`; raises FaultError."""
        kind, *words = text.lower().split() or [""]
        if kind not in _KINDS:
            raise FaultError(f"unknown fault {text!r}; faults are: {', '.join(_KINDS)}")
        fault = cls(kind, tuple(words))
        _KINDS[kind](fault.words)  # raises FaultError for invalid words
        return fault

    @property
    def text(self) -> str:
        """The fault as text."""
        return " ".join((self.kind, *self.words))

    @property
    def subject(self) -> str:
        """The subject of the fault, equal for a fault and its end."""
        if self.kind == "motor":
            return f"motor {float(self.words[0]):g}"
        if self.words[:1] in (("spoof",), ("sag",)):
            return f"{self.kind} {self.words[0]}"
        return self.kind

    def inject(self, vehicle: FaultTarget) -> None:
        """Inject the fault into a vehicle."""
        _LOG.info("vehicle %d: fault %s", vehicle.address.system, self.text)
        active = _KINDS[self.kind](self.words)(vehicle)
        vehicle.faults.note(self.subject, self.text if active else None)


@dataclass(frozen=True, slots=True)
class TimedFault:
    """A fault with its time in seconds; `system` 0 means every vehicle."""

    time: float
    system: int
    fault: Fault

    @classmethod
    def parse(cls, text: str, time: float = 0.0) -> TimedFault:
        """Parse `gps off` or `2: gps off`; raises FaultError."""
        who, colon, rest = text.partition(":")
        try:
            system = int(who) if colon else 0
        except ValueError:
            raise FaultError(f"{text.strip()!r} is not [SYSTEM:] FAULT") from None
        if not 0 <= system <= _MAX_SYSTEMS:
            raise FaultError(f"system id {system} is outside 0 to {_MAX_SYSTEMS}")
        return cls(time, system, Fault.parse(rest if colon else text))

    def inject(self, simulation: Simulation) -> None:
        """Inject the fault now."""
        for vehicle in simulation.fault_targets:
            if self.system in (0, vehicle.address.system):
                self.fault.inject(vehicle)


class FaultScript:
    """A script of timed faults.

    Args:
        lines: The lines of the script.

    Raises:
        FaultError: A line is malformed; the text has its number.
    """

    def __init__(self, lines: Iterable[str]) -> None:
        self.faults = sorted(
            (_timed(number, line) for number, line in enumerate(lines, 1) if _bare(line)),
            key=lambda timed: timed.time,
        )
        self._next = 0

    def run_in(
        self, simulation: Simulation, on_fault: Callable[[TimedFault], None] = lambda timed: None
    ) -> None:
        """Inject each fault at its time from now on.

        Args:
            simulation: The simulation that runs the script.
            on_fault: Called with each injected fault.
        """
        begun = simulation.elapsed

        def act(elapsed: float) -> None:
            for timed in self.inject_due(simulation, elapsed - begun):
                on_fault(timed)

        simulation.before_step.append(act)

    def inject_due(self, simulation: Simulation, elapsed: float) -> list[TimedFault]:
        """Inject the faults that are due after `elapsed` seconds, and return them."""
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
        raise FaultError(f"line {number}: {time} is not a time in seconds")
    try:
        return TimedFault.parse(rest, seconds)
    except FaultError as error:
        raise FaultError(f"line {number}: {error}") from None


# Kinds of faults. Each parser returns a function that injects the fault, and returns whether the fault is
# then active.


def _gps(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    if words[:1] == ("spoof",):
        north, east = _numbers("gps spoof NORTH EAST", words[1:], 2)

        def spoof(vehicle: FaultTarget) -> bool:
            vehicle.body.spoof_gps(north, east)
            return (north, east) != (0.0, 0.0)

        return spoof
    off = _is_off("gps off|on|spoof NORTH EAST", words)

    def lose(vehicle: FaultTarget) -> bool:
        vehicle.body.fail_gps(off)
        return off

    return lose


def _compass(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    (degrees,) = _numbers("compass DEGREES", words, 1)

    def turn(vehicle: FaultTarget) -> bool:
        vehicle.body.offset_compass(radians(degrees))
        return degrees != 0

    return turn


def _baro(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    (metres,) = _numbers("baro METRES", words, 1)

    def drift(vehicle: FaultTarget) -> bool:
        vehicle.body.drift_barometer(metres)
        return metres != 0

    return drift


def _motor(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    usage = "motor NUMBER off|on"
    (number,) = _numbers(usage, words[:1], 1)
    off = _is_off(usage, words[1:])
    if number != int(number) or not 1 <= number <= _MOTORS:
        raise FaultError(f"the motor number must be 1 to {_MOTORS}, got {words[0]}")

    def stop(vehicle: FaultTarget) -> bool:
        vehicle.body.fail_motor(int(number), off)
        return off and number <= AIRFRAMES[vehicle.vehicle_type].motors

    return stop


def _battery(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    usage = "battery sag VOLTS, or battery PERCENT"
    if words[:1] == ("sag",):
        (volts,) = _numbers(usage, words[1:], 1)
        if volts < 0:
            raise FaultError(f"the voltage sag must be at least 0 V, got {words[1]}")

        def sag(vehicle: FaultTarget) -> bool:
            vehicle.body.sag_battery(volts)
            return volts != 0

        return sag
    (percent,) = _numbers(usage, words, 1)
    if not 0 <= percent <= _PERCENT:
        raise FaultError(f"the battery must be 0 to 100 percent, got {words[0]}")

    def hold(vehicle: FaultTarget) -> bool:
        vehicle.body.recharge(percent / _PERCENT)
        return False

    return hold


def _radio(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    off = _is_off("radio off|on", words)

    def switch(vehicle: FaultTarget) -> bool:
        return vehicle.switch_transmitter(not off)

    return switch


def _link(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    off = _is_off("link off|on", words)

    def cut(vehicle: FaultTarget) -> bool:
        vehicle.cut(off)
        return off

    return cut


def _reboot(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    if words:
        raise FaultError("usage: reboot")

    def reboot(vehicle: FaultTarget) -> bool:
        vehicle.reboot()
        return False

    return reboot


def _power(words: Sequence[str]) -> Callable[[FaultTarget], bool]:
    if tuple(words) != ("cycle",):
        raise FaultError("usage: power cycle")

    def cycle(vehicle: FaultTarget) -> bool:
        vehicle.power_cycle()
        return False

    return cycle


_KINDS: Final[dict[str, Callable[[Sequence[str]], Callable[[FaultTarget], bool]]]] = {
    "gps": _gps,
    "compass": _compass,
    "baro": _baro,
    "motor": _motor,
    "battery": _battery,
    "radio": _radio,
    "link": _link,
    "reboot": _reboot,
    "power": _power,
}


def _numbers(usage: str, words: Sequence[str], count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        numbers = ()
    if len(numbers) != count or not all(map(isfinite, numbers)):
        raise FaultError(f"usage: {usage}")
    return numbers


def _is_off(usage: str, words: Sequence[str]) -> bool:
    if tuple(words) not in (("off",), ("on",)):
        raise FaultError(f"usage: {usage}")
    return words[0] == "off"
