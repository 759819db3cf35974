from __future__ import annotations

import shutil
import subprocess

import pytest

from mavstack.cli.completion.command import EXAMPLES, SHELLS
from mavstack.cli.completion.command_words import all_words
from mavstack.cli.registry import COMMANDS
from tests.cli.harness import examples_of

#: The words before the cursor and the last word, and some of the candidates.
CASES = [
    (["mav", ""], {"sim", "vehicle", "completion"}),
    (["mav", "pa"], {"param"}),
    (["mav", "param", "l"], {"list", "load"}),
    (["mav", "param", "load", "--d"], {"--dry-run"}),
    (["mav", "watch", "x", "--sort", ""], {"name", "rate", "count"}),
    (["mav", "param", "load", "fi"], {"first.param", "file two.param"}),
    (["mav", "completion", ""], {"bash", "zsh", "fish"}),
]


@pytest.fixture
def script(mav, tmp_path, monkeypatch):
    """Write the script of a shell beside some files, and return its path."""
    if shutil.which("bash") is None:
        pytest.skip("bash is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "first.param").touch()
    (tmp_path / "file two.param").touch()

    def write(shell):
        if shutil.which(shell) is None:
            pytest.skip(f"{shell} is not installed")
        path = tmp_path / f"_{shell}"
        path.write_text(mav("completion", shell).out)
        return path

    return write


def run(*words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return set(done.stdout.splitlines())


@pytest.mark.parametrize(("words", "expected"), CASES)
def test_bash_completes(script, words, expected):
    path = script("bash")
    typed = " ".join(f"'{word}'" for word in words)
    line = f"source {path}; COMP_WORDS=({typed}); COMP_CWORD={len(words) - 1}; _mav"
    found = run("bash", "--norc", "-c", f'{line}; printf "%s\\n" "${{COMPREPLY[@]}}"')
    assert expected <= found
    assert all(each.startswith(words[-1]) for each in found)


def test_bash_completes_the_value_after_an_equals_sign(script):
    """Bash gives `--sort=r` as three words."""
    line = f"source {script('bash')}; COMP_WORDS=(mav watch --sort = r); COMP_CWORD=4; _mav"
    assert run("bash", "--norc", "-c", f'{line}; printf "%s\\n" "${{COMPREPLY[@]}}"') == {"rate"}


@pytest.mark.parametrize(("words", "expected"), CASES)
def test_fish_completes(script, words, expected):
    path = script("fish")
    typed = " ".join(words)
    found = run("fish", "--no-config", "-c", f"source {path}; complete -C '{typed}'")
    assert expected <= {each.partition("\t")[0].replace("\\ ", " ") for each in found}


def test_zsh_reads_the_script(script):
    path = script("zsh")
    assert run("zsh", "-f", "-c", f"autoload -U compinit && compinit -u -D && source {path} && which _mav")


def test_every_command_and_option_is_in_every_script(mav):
    commands = all_words()
    assert {each.path for each in commands} >= {f"mav {name}" for name in COMMANDS}
    for shell in SHELLS:
        text = mav("completion", shell).out
        for command in commands:
            assert command.path in text
            for option in command.options:
                assert option.names[-1].lstrip("-") in text


def test_an_unknown_shell_is_refused(mav):
    result = mav("completion", "tcsh")
    assert result.code == 2
    assert "bash" in result.err


def test_examples_name_known_shells():
    assert [words[1] for words in examples_of(EXAMPLES)] == list(SHELLS)
