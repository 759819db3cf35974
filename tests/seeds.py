"""Randomised tests over many seeds: 300 by default, `--seeds N` for more, `--seed N` to replay one."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    import pytest

BLOCKS = 4
REPORT = "seeds run"


class Seeds:
    """The seeds of one test."""

    def __init__(self, numbers: range, node: pytest.Item) -> None:
        self.numbers = numbers
        self._node = node

    def check(self, scenario: Callable[[int], None]) -> None:
        """Run the scenario for each seed; a failure carries a note with the command that replays it."""
        begin = perf_counter()
        for seed in self.numbers:
            try:
                scenario(seed)
            except Exception as error:
                test = self._node.nodeid.partition("[")[0]
                error.add_note(f"replay: pytest '{test}' --seed {seed}")
                raise
        self._node.user_properties.append((REPORT, (len(self.numbers), perf_counter() - begin)))


def blocks_of(config: pytest.Config) -> list[range]:
    """Return the parameters of the `seeds` fixture: one seed to replay, or blocks that workers share."""
    one = config.getoption("--seed")
    if one is not None:
        return [range(one, one + 1)]
    total = config.getoption("--seeds")
    size = -(-total // BLOCKS)
    return [range(first, min(first + size, total)) for first in range(0, total, size)]
