"""Compilers for the tests: each is used if the machine has it, and its tests skip otherwise."""

from __future__ import annotations

import pytest

from tools.compilers import find


def needs(name: str) -> str:
    """Return the path of a program of `tools.compilers`, or skip the test with a reason that is counted."""
    path = find(name)
    if path is None:
        pytest.skip(f"compiler missing: {name} (python -m tools.compilers {name})")
    return path
