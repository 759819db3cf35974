"""Checks of the arguments of public calls: errors that name the argument, before anything is sent."""

from __future__ import annotations

from math import isfinite
from typing import SupportsFloat, SupportsIndex

from mavstack.errors import InvalidArgumentError, InvalidTypeError


def check_number(name: str, value: object, *, finite: bool = True) -> None:
    """Raise unless a value is a number.

    Args:
        name: The name of the argument, for the error.
        value: The argument.
        finite: Refuse infinities and NaN too.

    Raises:
        InvalidTypeError: The value is not a number.
        InvalidArgumentError: The value is not finite.
    """
    if not isinstance(value, SupportsFloat | SupportsIndex):
        raise InvalidTypeError(f"{name} must be a number, got {_described(value)}")
    if finite and not isfinite(value):
        raise InvalidArgumentError(f"{name} must be finite, got {value}")


def check_numbers(*, finite: bool = True, **arguments: object) -> None:
    """Raise unless every argument is a number, or None; see `check_number`."""
    for name, value in arguments.items():
        if value is not None:
            check_number(name, value, finite=finite)


def check_timeout(timeout: object) -> None:
    """Raise unless a timeout is a number of seconds, or None."""
    if timeout is not None and not isinstance(timeout, SupportsFloat | SupportsIndex):
        raise InvalidTypeError(f"timeout must be seconds or None, got {_described(timeout)}")


def check_text(name: str, value: object) -> None:
    """Raise unless a value is a text."""
    if not isinstance(value, str):
        raise InvalidTypeError(f"{name} must be a str, got {_described(value)}")


def _described(value: object) -> str:
    return f"{value!r:.60} ({type(value).__name__})"
