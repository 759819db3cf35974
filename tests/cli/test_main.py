from __future__ import annotations

import subprocess
import sys

import pytest

import mavstack
from mavstack.cli import main as main_module
from mavstack.cli.main import main
from mavstack.cli.registry import COMMANDS
from mavstack.errors import LinkError


def test_help_names_every_command_and_gives_examples(mav):
    result = mav("--help")
    assert result.code == 0
    assert all(f"\n  {name} " in result.out for name in COMMANDS)
    assert "examples:" in result.out


def test_without_arguments_help_is_shown(mav):
    assert mav().out == mav("--help").out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_with_examples(mav, name):
    result = mav(name, "--help")
    assert result.code == 0
    assert f"mav {name}" in result.out
    assert "examples:" in result.out
    assert not result.err


def test_version(mav):
    assert mav("--version").out == f"mavstack {mavstack.__version__}\n"


def test_unknown_command_suggests(mav):
    result = mav("wach")
    assert (result.code, result.out) == (2, "")
    assert result.err == "mav: there is no command 'wach'; did you mean watch?\n"


def test_unknown_option_of_mav(mav):
    result = mav("--verison")
    assert result.code == 2
    assert "--verison" in result.err


@pytest.mark.parametrize(
    "words", [["watch"], ["watch", "x", "--for", "soon"], ["dialect"], ["doctor", "now"]]
)
def test_wrong_usage_has_exit_code_2(mav, words):
    result = mav(*words)
    assert result.code == 2
    assert "usage: mav" in result.err


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (KeyboardInterrupt(), 130),
        (LinkError("the cable\nis out"), 1),
        (PermissionError(13, "Permission denied", "log"), 1),
    ],
)
def test_errors_become_exit_codes(monkeypatch, capsys, error, code):
    def fail(_words):
        raise error

    monkeypatch.setattr(main_module, "_dispatch", fail)
    assert main(["watch"]) == code
    assert capsys.readouterr().err.count("\n") == (0 if code == 130 else 1)


def test_help_imports_no_command():
    code = (
        "import sys; from mavstack.cli.main import main; main(['--help'])\n"
        "assert not {'asyncio', 'numpy', 'rich', 'xml', 'mavstack._core'} & set(sys.modules), sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


def test_a_summary_needs_no_extra(tlog):
    blocked = "for name in ('rich', 'serial', 'websockets', 'numpy'): sys.modules[name] = None\n"
    code = (
        f"import sys\n{blocked}from mavstack.cli.main import main\n"
        f"sys.exit(main(['watch', {str(tlog)!r}, '--once']) or main(['watch', {str(tlog)!r}, '--json'])"
        " or main(['dialect', 'list']))"
    )
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
