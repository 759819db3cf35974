"""Full matrices in the nightly tier, and a few of their cases in the fast one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def nightly_except(cases: Iterable[Any], fast: Callable[[Any], bool]) -> list[Any]:
    """Return the cases as parameters; those that are not `fast` run only in the nightly tier.

    Example:
        @pytest.mark.parametrize("kind", nightly_except(ALL, lambda kind: kind in COPTERS))
    """
    return [case if fast(case) else pytest.param(case, marks=pytest.mark.nightly) for case in cases]
