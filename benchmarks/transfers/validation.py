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


def _wrong_parameters(got: Mapping[str, float], expected: Expected) -> str:
    names = set(expected.parameters) - NOT_COUNTED
    missing = names - set(got)
    if missing:
        return f"{len(missing)} of {len(names)} parameters missing"
    differing = [
        name
        for name in names - expected.volatile
        if not math.isclose(got[name], expected.parameters[name], rel_tol=1e-5, abs_tol=1e-6)
        and not (math.isnan(got[name]) and math.isnan(expected.parameters[name]))
    ]
    return f"{len(differing)} parameters wrong, as {min(differing)}" if differing else ""


def _wrong_file(got: bytes, expected: bytes) -> str:
    if got == expected:
        return ""
    return f"{len(got)} of {len(expected)} bytes" if len(got) != len(expected) else "bytes differ"


def _wrong_plan(got: Sequence[Item], expected: Expected) -> str:
    if len(got) != len(expected.plan):
        return f"{len(got)} of {len(expected.plan)} items"
    pairs = list(zip(got, expected.plan, strict=True))[expected.home_first :]
    differing = sum(not _same(mine, theirs) for mine, theirs in pairs)
    return f"{differing} items wrong" if differing else ""


def _same(mine: Item, theirs: Item) -> bool:
    """Return whether items are equal, except for rounding in the vehicle's storage."""
    return (
        mine.command == theirs.command
        and INTEGER_FRAME.get(mine.frame, mine.frame) == INTEGER_FRAME.get(theirs.frame, theirs.frame)
        and abs(mine.x - theirs.x) <= 1
        and abs(mine.y - theirs.y) <= 1
        and abs(mine.z - theirs.z) <= 0.02
    )
