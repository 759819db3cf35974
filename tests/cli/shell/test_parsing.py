"""Any typed line becomes commands or one error message."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.parsing import UnfinishedLine, split_commands, split_unfinished

#: Lines with many quotes, separators and comments.
LINES = st.text(
    st.one_of(st.sampled_from("\"'\\;# \t-ab"), st.characters(exclude_categories=["Cs"])), max_size=40
)


@pytest.mark.parametrize(
    ("line", "commands"),
    [
        ("", []),
        ("   # nothing", []),
        ("arm throttle", [["arm", "throttle"]]),
        (
            "mode guided; arm throttle ;takeoff 10;",
            [["mode", "guided"], ["arm", "throttle"], ["takeoff", "10"]],
        ),
        ("say 'a; b' # and; so on", [["say", "a; b"]]),
        ('alias add up "mode guided; takeoff 10"', [["alias", "add", "up", "mode guided; takeoff 10"]]),
        (r"wp load my\ way.txt", [["wp", "load", "my way.txt"]]),
        ("output remove #1", [["output", "remove"]]),
        ("a#b", [["a#b"]]),
        ("say it\\'s", [["say", "it's"]]),
    ],
)
def test_lines(line, commands):
    assert split_commands(line) == commands


@pytest.mark.parametrize("line", ["say 'a", 'say "a; b', "a; say 'b", "end\\"])
def test_unclosed_quotation_is_an_error(line):
    with pytest.raises(UsageError, match="has no"):
        split_commands(line)


@pytest.mark.parametrize(
    ("text", "unfinished"),
    [
        ("", ([], "")),
        ("ar", ([], "ar")),
        ("arm ", (["arm"], "")),
        ("arm thr", (["arm"], "thr")),
        ("mode guided; ar", ([], "ar")),
        ("mode guided;", ([], "")),
        ("mode guided; ", ([], "")),
        ("wp load 'my way", (["wp", "load", "my"], "way")),
    ],
)
def test_words_before_the_cursor(text, unfinished):
    assert split_unfinished(text) == UnfinishedLine(*unfinished)


@pytest.mark.flight
@given(LINES)
def test_any_line_is_split_or_refused(line):
    try:
        commands = split_commands(line)
    except UsageError:
        return
    assert all(commands)


@given(LINES)
def test_any_text_can_be_completed(text):
    words, word = split_unfinished(text)
    assert isinstance(word, str)
    assert all(isinstance(each, str) for each in words)


@pytest.mark.flight
@given(st.lists(st.text("abc ;#'\"\\", min_size=1), min_size=1))
def test_quoted_words_are_preserved(words):
    import shlex

    assert split_commands(shlex.join(words)) == [words]
