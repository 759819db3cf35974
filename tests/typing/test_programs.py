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


def test_mypy_accepts_typical_programs_and_rejects_mistakes(tmp_path: Path) -> None:
    mistakes = {f"mistake_{number}": text for number, text in enumerate(MISTAKES)}
    for name, text in mistakes.items():
        (tmp_path / f"{name}.py").write_text(text)
    checked = run_mypy(*(str(HERE / program) for program in PROGRAMS), str(tmp_path))
    errors = [line for line in checked.stdout.splitlines() if ": error: " in line]
    assert sorted({Path(line.partition(":")[0]).stem for line in errors}) == sorted(mistakes)
    for name, text in mistakes.items():
        assert any(f"{name}.py:" in line and MISTAKES[text] in line for line in errors), name


@pytest.mark.interop
@pytest.mark.skipif(find_spec("pyright") is None, reason="pyright is not installed")
def test_pyright_accepts_typical_programs() -> None:
    arguments = ["--outputjson", "--pythonpath", sys.executable, *(str(HERE / each) for each in PROGRAMS)]
    command = [sys.executable, "-m", "pyright", *arguments]
    checked = subprocess.run(command, capture_output=True, text=True, check=False)
    found = json.loads(checked.stdout)["generalDiagnostics"]
    assert [each["message"] for each in found if each["severity"] == "error"] == []
