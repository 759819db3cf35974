"""The threat model: each line about an attacker names tests and rows of the attack suite that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tools.attacks.gates import GATES
from tools.attacks.lockouts import LOCKOUTS
from tools.attacks.reloads import RELOADS, UNSIGNED_RELOADS
from tools.attacks.scenarios import FACTORS, FLOOD, PASSED, PLAIN, UNSIGNED
from tools.attacks.station import DELAYS, STATION
from tools.attacks.texts import FORMULAS_ROW
from tools.attacks.vehicles import VEHICLES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs/explanation/threat-model.md").read_text("utf-8")
LINES = [
    [cell.strip() for cell in line.strip("| ").split(" | ")]
    for line in TEXT.partition("## Figures")[0].splitlines()
    if line.startswith("| ")
][1:]
TABLES = (
    PASSED,
    UNSIGNED,
    PLAIN,
    FACTORS,
    GATES,
    LOCKOUTS,
    RELOADS,
    UNSIGNED_RELOADS,
    VEHICLES,
    FLOOD,
    DELAYS,
    STATION,
)
ROWS = {FORMULAS_ROW, *(name for table in TABLES for name in table)}
#: The attacker who owns the vehicle is not stopped.
UNTESTED = {"has the vehicle's key, or the vehicle"}


def test_the_lines_are_read():
    assert len(LINES) >= 19
    assert {len(line) for line in LINES} == {4}


@pytest.mark.parametrize("line", LINES, ids=lambda line: line[0])
def test_each_line_names_tests_that_exist(line):
    files, rows = re.findall(r"`([^`]+)`", line[3]), re.findall(r'"([^"]+)"', line[3])
    assert bool(files or rows) is (line[0] not in UNTESTED)
    assert set(rows) <= ROWS
    for each in files:
        path, _, name = each.partition("::")
        text = (ROOT / path).read_text("utf-8")
        assert not name or f"def {name}(" in text


def test_the_last_row_of_the_figures_is_their_sum():
    lines = TEXT.partition("## Figures")[2].partition("| all ")
    rows = [line for line in lines[0].splitlines() if line.startswith("| ")][1:]
    figures = [[cell.strip() for cell in line.strip("| ").split(" | ")][1:] for line in rows]
    sums = [sum(int(cell) for cell in column if cell.isdecimal()) for column in zip(*figures, strict=True)]
    assert [int(cell) for cell in lines[2].partition("\n")[0].strip("| ").split(" | ")] == sums
