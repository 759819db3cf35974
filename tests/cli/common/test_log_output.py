from __future__ import annotations

import logging
import warnings
from argparse import ArgumentParser, Namespace

import pytest

from mavstack.cli.common.log_output import (
    add_logging_options,
    logging_to_outputs,
    stderr_log_held,
    warnings_as_lines,
)
from mavstack.cli.registry import COMMANDS, actions_of, command_parser
from mavstack.errors import MissionWarning

LOGGER = logging.getLogger("mavstack.links")


def parse(*words: str) -> Namespace:
    parser = ArgumentParser()
    add_logging_options(parser)
    return parser.parse_args(words)


def log_one_of_each() -> None:
    LOGGER.debug("a debug message")
    LOGGER.info("an info message")
    LOGGER.warning("a warning")


@pytest.mark.parametrize(
    ("words", "shown"),
    [((), 0), (("-v",), 2), (("-vv",), 3), (("--verbose",), 2), (("-v", "-v"), 3), (("-vvv",), 3)],
)
def test_verbosity_selects_the_level(capsys, words, shown):
    with logging_to_outputs(parse(*words)):
        log_one_of_each()
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.splitlines()
    assert len(lines) == shown
    assert all(" mavstack.links: " in line for line in lines)


def test_log_file_has_debug_messages_and_is_appended_to(tmp_path, capsys):
    path = tmp_path / "mav.log"
    for _ in range(2):
        with logging_to_outputs(parse("--log-file", str(path))):
            log_one_of_each()
    lines = path.read_text().splitlines()
    assert len(lines) == 6
    assert lines[0].endswith("DEBUG mavstack.links: a debug message")
    assert capsys.readouterr().err == ""


def test_handlers_and_level_are_restored(tmp_path):
    logger = logging.getLogger("mavstack")
    before = logger.level, list(logger.handlers)
    with logging_to_outputs(parse("-vv", "--log-file", str(tmp_path / "mav.log"))):
        assert logger.handlers != before[1]
    assert (logger.level, logger.handlers) == before


def test_a_block_that_logs_nothing_needs_a_handler_only_for_the_options(capsys):
    before = list(logging.getLogger("mavstack").handlers)
    with logging_to_outputs(parse(), quiet=True):
        assert logging.getLogger("mavstack").handlers == before
    with logging_to_outputs(parse("-v"), quiet=True):
        log_one_of_each()
    assert len(capsys.readouterr().err.splitlines()) == 2


def test_failed_command_is_logged_with_its_traceback(capsys):
    with pytest.raises(ValueError, match="defect"), logging_to_outputs(parse("-vv")):
        raise ValueError("a defect")
    assert "Traceback" in capsys.readouterr().err


def test_lines_are_held_while_a_display_covers_the_terminal(capsys):
    with logging_to_outputs(parse("-v")):
        with stderr_log_held():
            LOGGER.info("held")
            assert capsys.readouterr().err == ""
        assert "held" in capsys.readouterr().err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_and_action_has_the_options(name):
    parser = command_parser(name)
    for each in (parser, *(action for _, _, action in actions_of(parser))):
        assert "--log-file FILE" in each.format_help()
        # the option -v of `mav param get` describes the parameters
        assert ("--verbose" if each.prog == "mav param get" else "-v, --verbose") in each.format_help()


def test_options_before_and_after_the_action(mav, tmp_path):
    for words in (("-vv", "list"), ("list", "-vv")):
        path = tmp_path / "mav.log"
        result = mav("dialect", *words, "--log-file", path)
        assert result.code == 0
        assert path.exists()


def test_log_file_that_cannot_be_written_is_one_line(mav, tmp_path):
    result = mav("dialect", "list", "--log-file", tmp_path / "none" / "mav.log")
    assert result.code == 1
    assert result.err.count("\n") == 1
    assert "mav.log" in result.err


def test_log_of_a_link_shows_no_secret(mav, tmp_path):
    path = tmp_path / "mav.log"
    url = "udpin://127.0.0.1:0?password=hunter2secret&key=hunter2secret&token=hunter2secret"
    mav("watch", url, "--once", "--for", 0.1, "-vv", "--log-file", path)
    assert "hunter2secret" not in path.read_text()


def test_log_of_a_link_names_it(mav, tmp_path):
    path = tmp_path / "mav.log"
    mav("watch", "udpin://127.0.0.1:0", "--once", "--for", 0.1, "--log-file", path)
    assert "udpin://127.0.0.1:0" in path.read_text()


def test_a_mission_warning_is_one_line(capsys):
    with warnings_as_lines("mav mission"):
        warnings.warn("the mission begins\n18,070 km away", MissionWarning, stacklevel=1)
    assert capsys.readouterr().err == "mav mission: warning: the mission begins 18,070 km away\n"


def test_other_warnings_stay_as_python_shows_them():
    with pytest.warns(UserWarning, match="other"), warnings_as_lines("mav mission"):
        warnings.warn("other", UserWarning, stacklevel=1)
