"""The counts of redundancy do not rise: lower the limits when the code gets below them."""

from __future__ import annotations

import ast
from pathlib import Path

from tools.redundancy import SOURCES, pass_through_functions, single_protocols

MAX_SINGLE_PROTOCOLS, MAX_PASS_THROUGH_FUNCTIONS = 2, 132

PROGRAM = """
class Reader(Protocol):
    def open(self): ...
    def read(self): ...
    def close(self): ...

class Several(Protocol):
    def start(self): ...
    def stop(self): ...
    def wait(self): ...

class File:
    def open(self): ...
    def read(self): ...
    def close(self): ...

class Timer:
    def start(self): ...
    def stop(self): ...
    def wait(self): ...

class Clock(Timer):
    def wait(self, a): return other(a)

class Motor:
    def start(self): ...
    def stop(self): ...
    def wait(self): ...

def passes(a, *, b): return other(a, b=b)
async def passes_too(self, a): await self.part.passes_too(self.b, a)
def adds(a): return other(a, 7)
def adds_a_constant(a): return other(a, _LIMIT)
def adds_a_member(a): return other(a, _COMMAND.LAND)
def leaves_out(a, b): return other(a)
def changes(a): return other(a + 1)
"""


def test_protocols_of_one_class_and_functions_that_pass_on_are_found():
    trees = {SOURCES / "program.py": ast.parse(PROGRAM)}
    assert list(single_protocols(trees)) == ["program.py:2: Reader = File"]
    names = [place.rpartition(" ")[2] for place in pass_through_functions(trees)]
    assert names == ["passes", "passes_too"]


def test_the_counts_do_not_rise():
    trees = {path: ast.parse(path.read_text("utf-8")) for path in sorted(Path(SOURCES).rglob("*.py"))}
    assert len(list(single_protocols(trees))) <= MAX_SINGLE_PROTOCOLS
    assert len(list(pass_through_functions(trees))) <= MAX_PASS_THROUGH_FUNCTIONS
