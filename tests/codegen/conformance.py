"""The conformance corpus for a runner: a program that parses with a generated library, or with a peer."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

CORPUS = Path(__file__).parents[2] / "conformance"
MAX_SHOWN = 5


@dataclass(frozen=True)
class Result:
    """The lines that a runner printed for one input."""

    name: str
    expected: list[str]
    printed: list[str]

    @property
    def category(self) -> str:
        return self.name.partition("/")[0]

    @property
    def passed(self) -> bool:
        return self.printed == self.expected

    def __str__(self) -> str:
        pairs = [*zip(self.expected, self.printed, strict=False)]
        different = next((pair for pair in pairs if pair[0] != pair[1]), None)
        if different is None:
            return f"{self.name}: {len(self.printed)} lines, expected {len(self.expected)}"
        return (
            f"{self.name}:\n  expected {_difference(*different)}\n  printed  {_difference(*different[::-1])}"
        )


def _difference(line: str, other: str) -> str:
    """Return the kind and the words of a line that differ from the other line."""
    words, others = line.split(), other.split()
    if words[:1] != others[:1]:
        return line[:200]
    return " ".join([*words[:2], *(word for word in words[2:] if word not in others)])[:200]


@cache
def corpus(dialect: str) -> tuple[dict[str, Any], ...]:
    """Return the inputs of a dialect with their results."""
    lines = (CORPUS / f"{dialect}.jsonl").read_text("ascii").splitlines()
    return tuple(json.loads(line) for line in lines)


def input_line(case: dict[str, Any]) -> str:
    """Return the line that a runner reads."""
    now = "-" if case["now"] is None else case["now"]
    return f"{case['name']} {case['key'] or '-'} {now} {case['input']}\n"


def expected_lines(case: dict[str, Any]) -> Iterator[str]:
    """Yield the lines that a runner prints."""
    for packet in case["packets"]:
        header = (packet[item] for item in ("message", "id", "version", "sequence", "system", "component"))
        fields = (f"{name}={value}" for name, value in packet["fields"].items())
        yield " ".join(["packet", *map(str, header), str(int(packet["signed"])), *fields])
        yield f"packed {packet['message']} {packet['packed']}"
    counters = " ".join(f"{name}={value}" for name, value in case["counters"].items())
    yield f"end {case['name']} {counters}"


def run(
    command: Sequence[str | Path],
    dialect: str,
    *,
    messages: Collection[str] | None = None,
    timeout: float = 100,
) -> list[Result]:
    """Return the results of a runner.

    Args:
        command: The command line of the runner.
        dialect: "common" or "all".
        messages: Names of the messages that the library has; None for all of the dialect.
        timeout: Maximum time in seconds.
    """
    cases = [case for case in corpus(dialect) if messages is None or _uses_only(case, messages)]
    finished = subprocess.run(
        [*map(str, command)],
        input="".join(map(input_line, cases)),
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
    assert finished.returncode == 0, f"the runner failed: {finished.stderr[-2000:]}"
    return _results(cases, finished.stdout.splitlines())


def _uses_only(case: dict[str, Any], messages: Collection[str]) -> bool:
    return case["name"].startswith("message/") and case["name"].partition("/")[2] in messages


def _results(cases: Iterable[dict[str, Any]], printed: list[str]) -> list[Result]:
    """Split the printed lines at the end of each input."""
    results, lines = [], iter(printed)
    for case in cases:
        found = []
        for line in lines:
            found.append(line.rstrip())
            if line.startswith("end "):
                break
        results.append(Result(case["name"], list(expected_lines(case)), found))
    rest = list(lines)
    assert not rest, f"the runner printed lines after the last input: {rest[:MAX_SHOWN]}"
    return results


def check_runner(
    command: Sequence[str | Path],
    dialect: str,
    *,
    messages: Collection[str] | None = None,
    skip: Collection[str] = (),
    timeout: float = 100,
) -> None:
    """Run a program over the corpus, and fail with the first differences.

    Args:
        command: The command line of the runner.
        dialect: "common" or "all".
        messages: Names of the messages that the library has; None for all of the dialect.
        skip: Categories that are not compared.
        timeout: Maximum time in seconds.
    """
    results = [
        result
        for result in run(command, dialect, messages=messages, timeout=timeout)
        if result.category not in skip
    ]
    failed = [result for result in results if not result.passed]
    shown = "\n".join(map(str, failed[:MAX_SHOWN]))
    assert not failed, f"{len(failed)} of {len(results)} inputs differ:\n{shown}"


def summary(results: Iterable[Result]) -> dict[str, tuple[int, int]]:
    """Return the number of inputs passed and the number of all inputs, by category."""
    results = list(results)
    total = Counter(result.category for result in results)
    passed = Counter(result.category for result in results if result.passed)
    return {name: (passed[name], count) for name, count in total.items()}
