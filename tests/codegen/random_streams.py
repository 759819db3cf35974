"""Damaged streams for runners: pieces of the conformance corpus with faults; the core tells the packets."""

from __future__ import annotations

import subprocess
from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects.dialect import Dialect
from tests.codegen.conformance import corpus, expected_lines, input_line
from tools.conformance.cases import Case
from tools.conformance.corpus import line

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from typing import Any


def check_random_streams(command: Sequence[str | Path], dialect: str, seed: int, count: int = 200) -> None:
    """Run a program over damaged streams, and fail if its output differs from the core's."""
    random = Random(seed)
    cases = [_case(random, dialect, f"random/{seed}-{number}") for number in range(count)]
    finished = subprocess.run(
        [*map(str, command)],
        input="".join(map(input_line, cases)), capture_output=True, text=True, check=True,
    )  # fmt: skip
    expected = [text for case in cases for text in expected_lines(case)]
    assert finished.stdout.splitlines() == expected, f"seed {seed}"


def _case(random: Random, dialect: str, name: str) -> dict[str, Any]:
    chosen = random.choices(corpus(dialect), k=random.randint(1, 6))
    data = bytearray().join(_damaged(random, bytes.fromhex(case["input"])) for case in chosen)
    key = chosen[0]["key"]
    case = Case(name, bytes(data), bytes.fromhex(key) if key else None, chosen[0]["now"])
    return line(case, Dialect.load(dialect))


def _damaged(random: Random, data: bytes) -> bytearray:
    """Return data with bytes changed, removed, repeated and inserted, magics more often than others."""
    result = bytearray(data)
    for _ in range(random.choice((0, 1, 1, 2, 5))):
        start = random.randrange(len(result) + 1)
        end = min(len(result), start + random.choice((0, 1, 1, 2, 13, 40)))
        piece = bytes(
            random.choice((0xFD, 0xFE, 0, random.randrange(256))) for _ in range(random.randrange(4))
        )
        result[start:end] = random.choice((piece, bytes(result[start:end]) * 2, b""))
    return result
