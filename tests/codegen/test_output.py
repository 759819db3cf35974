from __future__ import annotations

from pathlib import Path

import pytest

from mavstack.codegen import generate, make_library, outdated_files, write_files
from mavstack.codegen.language import LANGUAGES
from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError

COMMON = Dialect.load("common")
FEW = make_library(COMMON, only=["HEARTBEAT", "ATTITUDE"])
ONE = make_library(COMMON, only=["ATTITUDE"])

pytestmark = pytest.mark.usefixtures("plugins")


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_files_are_sorted_and_listed():
    files = generate(FEW, "text")
    assert [file.path for file in files] == [
        ".mavgen-text.txt",
        "README.md",
        "messages/attitude.txt",
        "messages/heartbeat.txt",
    ]
    assert files[0].text == "README.md\nmessages/attitude.txt\nmessages/heartbeat.txt\n"


def test_a_second_run_changes_nothing(tmp_path):
    written = write_files(generate(FEW, "text"), tmp_path / "new" / "folder")
    assert len(written) == 4
    times = [Path(path).stat().st_mtime_ns for path in written]
    assert write_files(generate(FEW, "text"), tmp_path / "new" / "folder") == []
    assert [Path(path).stat().st_mtime_ns for path in written] == times


def test_files_of_messages_that_are_gone_are_removed_and_others_stay(tmp_path):
    write_files(generate(FEW, "text"), tmp_path)
    (tmp_path / "messages" / "mine.txt").write_text("mine")
    changed = write_files(generate(ONE, "text"), tmp_path)
    assert str(tmp_path / "messages" / "heartbeat.txt") in changed
    assert names(tmp_path) == [".mavgen-text.txt", "README.md", "messages/attitude.txt", "messages/mine.txt"]


def test_outdated_files_are_missing_changed_or_left_over(tmp_path):
    files = generate(FEW, "text")
    assert len(outdated_files(files, tmp_path)) == 4
    write_files(files, tmp_path)
    (tmp_path / "README.md").unlink()
    (tmp_path / "messages" / "attitude.txt").write_text("edited")
    assert {Path(path).name for path in outdated_files(files, tmp_path)} == {"README.md", "attitude.txt"}
    write_files(files, tmp_path)
    assert str(tmp_path / "messages" / "heartbeat.txt") in outdated_files(generate(ONE, "text"), tmp_path)


def test_a_file_of_the_user_is_not_overwritten(tmp_path):
    (tmp_path / "README.md").write_text("mine")
    with pytest.raises(FileExistsError) as error:
        write_files(generate(FEW, "text"), tmp_path)
    assert error.value.filename == str(tmp_path / "README.md")
    assert names(tmp_path) == ["README.md"]
    write_files(generate(FEW, "text"), tmp_path, overwrite=True)
    assert (tmp_path / "README.md").read_text() == "# common\n"


def test_a_list_with_paths_elsewhere_removes_nothing_there(tmp_path):
    outside, folder = tmp_path / "outside.txt", tmp_path / "out"
    outside.write_text("mine")
    folder.mkdir()
    (folder / ".mavgen-text.txt").write_text(f"../outside.txt\n{outside}\n\n")
    write_files(generate(ONE, "text"), folder)
    assert outside.read_text() == "mine"


@pytest.mark.parametrize("name", ["escaping", "absolute", "doubled"])
def test_a_language_cannot_write_elsewhere_or_twice(name):
    with pytest.raises(InvalidArgumentError, match=f"language {name} generates"):
        generate(ONE, name)


@pytest.mark.parametrize("name", LANGUAGES)
def test_every_file_has_the_licence_and_the_stamp(name):
    files = [file for file in generate(FEW, name)[1:] if not file.path.endswith((".json", ".mod"))]
    assert files
    for file in files:
        assert FEW.digest in file.text[:400], file.path
        assert "MIT" in file.text[:400], file.path
        assert file.text.endswith("\n")
        assert not file.text.endswith("\n\n"), file.path


@pytest.mark.parametrize("name", LANGUAGES)
def test_every_language_has_a_readme(name):
    assert "README.md" in {file.path for file in generate(FEW, name)}
