from __future__ import annotations

import tomllib

import pytest

from mavstack.router.config.lines import LineFinder

TEXT = '''\
# a comment = with an equals sign
top = 1

[a]
text = """
[not.a.table]
b = 2
"""
list = [
  1,  # [neither]
  2,
]
inner = { x = 1, y = { z = 2 } }
"quoted key" = 1
dotted.key = 2

[[a.rules]]
name = "first"
[[a.rules]]
name = "second"
[a.rules.place]
x = 1
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("top",), 2),
        (("a",), 4),
        (("a", "text"), 5),
        (("a", "list"), 9),
        (("a", "inner", "y", "z"), 13),
        (("a", "quoted key"), 14),
        (("a", "dotted", "key"), 15),
        (("a", "rules", 0, "name"), 18),
        (("a", "rules", 1), 19),
        (("a", "rules", 1, "name"), 20),
        (("a", "rules", 1, "place", "x"), 22),
    ],
)
def test_keys_have_lines(path, line):
    assert LineFinder(TEXT).line(path) == line


def test_missing_keys_are_at_their_table():
    finder = LineFinder(TEXT)
    assert finder.line(("a", "rules", 0, "missing")) == 17
    assert finder.line(("nothing",)) == 1


def test_a_long_array_is_not_parsed_line_by_line(monkeypatch):
    calls = []
    monkeypatch.setattr(tomllib, "loads", lambda text, loads=tomllib.loads: calls.append(text) or loads(text))
    finder = LineFinder("a = [\n" + "1,\n" * 500 + "]\nb = 2\n")
    assert (finder.line(("b",)), len(calls)) == (503, 5)
