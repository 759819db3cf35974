"""Validation of transferred data: compared with a reading over the clean relay, or with the sent data.

A parameter that differs between two readings over the clean relay is changed by the vehicle itself, and only
its name is compared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .model import Item, Outcome, Result, Work

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

NOT_COUNTED = frozenset({"_HASH_CHECK"})  # not in the parameter count
INTEGER_FRAME = {0: 5, 3: 6, 10: 11}  # frames with float and with integer coordinates


@dataclass(frozen=True, slots=True)
class Expected:
    """The expected data."""

    parameters: Mapping[str, float]
    volatile: frozenset[str]
    file: bytes
    plan: tuple[Item, ...]
    home_first: bool


def volatile(first: Mapping[str, float], second: Mapping[str, float]) -> frozenset[str]:
    """Return the parameters that changed between two readings."""
    return frozenset(name for name, value in first.items() if second.get(name) != value)


def outcome(work: Work, result: Result, expected: Expected) -> Outcome:
    """Validate a result."""
    if result.seconds is None or result.problem:
        return Outcome(None, result.problem or "failed")
    wrong = {
        Work.PARAMETERS: lambda: _wrong_parameters(result.parameters, expected),
        Work.FILE: lambda: _wrong_file(result.file, expected.file),
        Work.MISSION_UP: lambda: _wrong_plan(result.plan, expected),
        Work.MISSION_DOWN: lambda: _wrong_plan(result.plan, expected),
    }[work]()
    return Outcome(result.seconds, wrong)


def _wrong_parameters(received: Mapping[str, float], expected: Expected) -> str:
    names = set(expected.parameters) - NOT_COUNTED
    missing = names - set(received)
    if missing:
        return f"{len(missing)} of {len(names)} parameters missing"
    differing = [
        name
        for name in names - expected.volatile
        if not math.isclose(received[name], expected.parameters[name], rel_tol=1e-5, abs_tol=1e-6)
        and not (math.isnan(received[name]) and math.isnan(expected.parameters[name]))
    ]
    return f"{len(differing)} parameters wrong, such as {min(differing)}" if differing else ""


def _wrong_file(received: bytes, expected: bytes) -> str:
    if received == expected:
        return ""
    return f"{len(received)} of {len(expected)} bytes" if len(received) != len(expected) else "bytes differ"


def _wrong_plan(received: Sequence[Item], expected: Expected) -> str:
    if len(received) != len(expected.plan):
        return f"{len(received)} of {len(expected.plan)} items"
    pairs = list(zip(received, expected.plan, strict=True))[expected.home_first :]
    differing = sum(not _same(item, expected_item) for item, expected_item in pairs)
    return f"{differing} items wrong" if differing else ""


def _same(item: Item, expected_item: Item) -> bool:
    """Return whether items are equal, except for rounding in the vehicle's storage."""
    return (
        item.command == expected_item.command
        and INTEGER_FRAME.get(item.frame, item.frame)
        == INTEGER_FRAME.get(expected_item.frame, expected_item.frame)
        and abs(item.x - expected_item.x) <= 1
        and abs(item.y - expected_item.y) <= 1
        and abs(item.z - expected_item.z) <= 0.02
    )
