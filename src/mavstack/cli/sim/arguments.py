"""Types of the arguments of `mav sim`."""

from __future__ import annotations

from argparse import ArgumentTypeError
from math import inf
from typing import TYPE_CHECKING

from mavstack.errors import MavstackError
from mavstack.sim.vehicle_types import Home

if TYPE_CHECKING:
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.motion.obstacles import Obstacle
    from mavstack.sim.rangefinders import Rangefinder


def count(text: str) -> int:
    """Parse a number of vehicles; raises ArgumentTypeError."""
    if not (text.isdecimal() and 1 <= int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not a number of vehicles, 1 to 255")
    return int(text)


def home(text: str) -> Home:
    """Parse a home; raises ArgumentTypeError."""
    try:
        return Home.parse(text)
    except MavstackError as error:
        raise ArgumentTypeError(str(error)) from None


def rangefinder(text: str) -> Rangefinder:
    """Parse a rangefinder; raises ArgumentTypeError."""
    from mavstack.sim.rangefinders import Rangefinder

    try:
        return Rangefinder.parse(text)
    except MavstackError as error:
        raise ArgumentTypeError(str(error)) from None


def version(text: str) -> FirmwareVersion:
    """Parse a version, such as 4.1; raises ArgumentTypeError."""
    from mavstack.services.version import FirmwareVersion

    parts = text.split(".")
    if not (2 <= len(parts) <= 3 and all(part.isdecimal() and int(part) <= 255 for part in parts)):
        raise ArgumentTypeError(f"{text!r} is not a version, such as 4.1 or 4.6.3")
    return FirmwareVersion(*map(int, parts))


def obstacle(text: str) -> Obstacle:
    """Parse an obstacle; raises ArgumentTypeError."""
    from mavstack.sim.motion.obstacles import Obstacle

    try:
        return Obstacle.parse(text)
    except MavstackError as error:
        raise ArgumentTypeError(str(error)) from None


def share(text: str) -> float:
    """Parse a share; raises ArgumentTypeError."""
    return number(text, 0.0, 1.0, "a share from 0 to 1")


def milliseconds(text: str) -> float:
    """Parse a delay in milliseconds; raises ArgumentTypeError."""
    return number(text, 0.0, 60_000.0, "a delay of 0 to 60000 ms")


def speed(text: str) -> float:
    """Parse a speed of the simulation; `max` is infinite; raises ArgumentTypeError."""
    return inf if text == "max" else number(text, 0.01, 1000.0, "a speed of 0.01 to 1000, or max")


def wind(text: str) -> tuple[float, float, float]:
    """Parse a wind; raises ArgumentTypeError."""
    expected = "a wind SPEED,FROM[,GUSTS] such as 5,270,0.2"
    parts = text.split(",")
    if not 2 <= len(parts) <= 3:
        raise ArgumentTypeError(f"{text!r} is not {expected}")
    strength, direction, gusts = (number(part, -360.0, 360.0, expected) for part in (*parts, "0.1")[:3])
    return strength, direction, gusts


def number(text: str, minimum: float, maximum: float, expected: str) -> float:
    """Parse a number within limits; raises ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = inf
    if not minimum <= value <= maximum:
        raise ArgumentTypeError(f"{text!r} is not {expected}")
    return value
