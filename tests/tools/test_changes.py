"""Notes of changes: each file has an existing area and kind, and towncrier joins them to release notes."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CHANGES = ROOT / "changes"
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["towncrier"]
AREAS = [section["path"] for section in SETTINGS["section"]]
KINDS = [kind["directory"] for kind in SETTINGS["type"]]


def is_note(path: Path) -> bool:
    area, name = path.relative_to(CHANGES).parts
    start, _, kind = name.removesuffix(".md").partition(".")
    return area in AREAS and kind in KINDS and start.startswith("+") and name.endswith(".md")


@pytest.mark.parametrize(
    ("path", "valid"),
    [
        ("vehicles/+tolerance.added.md", True),
        ("vehicle/+tolerance.added.md", False),
        ("vehicles/+tolerance.new.md", False),
        ("vehicles/tolerance.added.md", False),
    ],
)
def test_names_of_notes(path: str, valid: bool) -> None:
    assert is_note(CHANGES / path) is valid


def test_each_file_is_a_note() -> None:
    files = [path for path in CHANGES.rglob("*") if path.is_file() and path.parent != CHANGES]
    assert [path.name for path in files if not is_note(path)] == []


def test_the_guide_lists_the_areas() -> None:
    guide = (CHANGES / "README.md").read_text("utf-8")
    assert [area for area in AREAS if f"| `{area}` |" not in guide] == []


def test_towncrier_joins_the_notes(tmp_path: Path) -> None:
    shutil.copytree(CHANGES, tmp_path / "changes")
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    shutil.copy(ROOT / "CHANGELOG.md", tmp_path)
    note = tmp_path / "changes" / "vehicles" / "+example.fixed.md"
    note.parent.mkdir(exist_ok=True)
    note.write_text("An example of a note.\n", "utf-8")
    command = [
        sys.executable,
        "-m",
        "towncrier",
        "build",
        "--version",
        "9.9.9",
        "--date",
        "2030-01-02",
        "--yes",
    ]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    written = (tmp_path / "CHANGELOG.md").read_text("utf-8")
    assert "## 9.9.9 (2030-01-02)\n" in written
    area = written.partition("### Vehicles\n")[2].partition("\n### ")[0]
    assert "- An example of a note.\n" in area.partition("#### Fixed\n")[2]
    assert written.startswith("# Changelog\n")
    assert not note.exists()
