"""Type checkers accept typical programs, and reject typical mistakes."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.type_checkers import run_mypy

HERE = Path(__file__).parent
PROGRAMS = ("async_programs.py", "blocking_programs.py")
#: Mistakes in a blocking program, and a word of the message of a type checker.
MISTAKES = {
    "import mavstack.sync\nasync def main() -> None:\n    await mavstack.sync.connect('x')\n": "await",
    "from mavstack.sync import Driver\n": "Driver",
    "from mavstack.sync import Vehicle\ndef arm(one: Vehicle) -> None:\n    one.armed = True\n": "armed",
}


@pytest.mark.parametrize("program", PROGRAMS)
def test_mypy_accepts_typical_programs(program: str) -> None:
    checked = run_mypy(str(HERE / program))
    assert (checked.stdout, checked.returncode) == ("", 0)


@pytest.mark.parametrize("number", range(len(MISTAKES)))
def test_mypy_rejects_mistakes(number: int, tmp_path: Path) -> None:
    text, word = list(MISTAKES.items())[number]
    program = tmp_path / "mistake.py"
    program.write_text(text)
    checked = run_mypy(str(program))
    assert checked.returncode == 1
    assert word in checked.stdout


@pytest.mark.interop
@pytest.mark.skipif(find_spec("pyright") is None, reason="pyright is not installed")
def test_pyright_accepts_typical_programs() -> None:
    arguments = ["--outputjson", "--pythonpath", sys.executable, *(str(HERE / each) for each in PROGRAMS)]
    command = [sys.executable, "-m", "pyright", *arguments]
    checked = subprocess.run(command, capture_output=True, text=True, check=False)
    found = json.loads(checked.stdout)["generalDiagnostics"]
    assert [each["message"] for each in found if each["severity"] == "error"] == []
