from __future__ import annotations

import shlex

import pytest

from mavstack.cli.reference import cli_reference, command_reference, main, shell_reference
from mavstack.cli.registry import COMMANDS, actions_of, command_parser
from mavstack.cli.shell.registry import COMMANDS as SHELL_COMMANDS


@pytest.fixture(scope="module")
def reference() -> str:
    return cli_reference()


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_action_and_option_is_there(reference, name):
    assert f"\n## mav {name}\n" in reference
    parser = command_parser(name)
    for action, _, _ in actions_of(parser):
        assert f"\n### mav {name} {action}\n" in reference
    own = command_reference(name)
    for each in (parser, *(action for _, _, action in actions_of(parser))):
        for option in (option for action in each._actions for option in action.option_strings):
            assert option in own or option in ("--help", "-h", "--verbose")


@pytest.mark.parametrize("name", COMMANDS)
def test_choices_are_plain_names(name):
    """Argparse shows the `repr` of each choice in its error; a member of an enum has a long one."""
    parser = command_parser(name)
    for each in (parser, *(action for _, _, action in actions_of(parser))):
        for argument in each._actions:
            if argument.choices is not None and not isinstance(argument.choices, dict):
                assert {type(choice) for choice in argument.choices} <= {str, int}, argument.dest


def test_every_argument_has_a_meaning(reference):
    assert not [line for line in reference.splitlines() if line.startswith("| `") and line.endswith("|  |")]


def test_examples_are_shell_lines(reference):
    lines = [line for line in reference.splitlines() if line.startswith("mav ")]
    assert lines
    for line in lines:
        shlex.split(line, comments=True)


def test_no_table_row_is_broken(reference):
    rows = [line for line in reference.splitlines() if line.startswith("| ")]
    assert all(line.replace("\\|", "").count("|") == 3 for line in rows)


def test_every_shell_command_is_there():
    text = shell_reference()
    assert all(f"\n## {command.name}\n" in text for command in SHELL_COMMANDS.values())


def test_main_prints_the_named_commands(capsys):
    main(["log", "ftp"])
    out = capsys.readouterr().out
    assert out.startswith("# mav log\n")
    assert "\n# mav ftp\n" in out
    assert "# mav sim" not in out
