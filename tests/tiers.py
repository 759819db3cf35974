"""Tiers: `make flights` and `make interop` collect only the files that name the marker of their tier."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

#: Pattern that a file with a test of a tier contains, by the marker of the tier; as in the Makefile.
NAMES: Final = {"interop": r"mark\.(interop)", "flight": r"mark\.(flight|fast_cases)"}


@cache
def names_tier(path: Path, tier: str) -> bool:
    """Return whether the text of a file names a tier."""
    return re.search(NAMES[tier], path.read_text()) is not None


def check_that_files_name_tiers(items: Iterable[pytest.Item]) -> None:
    """Refuse tests whose marker comes from another file, since their tier would not run them.

    Args:
        items: The collected tests with their markers.

    Raises:
        UsageError: A test has the marker of a tier that its file does not name.
    """
    for item in items:
        for tier in NAMES:
            if item.get_closest_marker(tier) and not names_tier(item.path, tier):
                raise pytest.UsageError(
                    f"{item.path}: {item.name} is marked {tier}, but the file does not contain mark.{tier}; "
                    "name the marker there"
                )
