"""The programs that check generated code are found and named."""

from __future__ import annotations

import pytest

from tools import compilers


def test_a_program_of_this_machine_is_found(tmp_path, monkeypatch) -> None:
    program = tmp_path / "clang"
    program.write_text("#!/bin/sh\n", "utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert compilers.find("clang") == str(program)


def test_a_program_without_its_libraries_is_missing(monkeypatch) -> None:
    program = compilers.Program(("sh",), files=("/nonexistent/*/stdint.h",))
    monkeypatch.setitem(compilers.PROGRAMS, "half", program)
    assert compilers.find("half") is None


def test_groups_name_programs() -> None:
    assert all(name in compilers.PROGRAMS for names in compilers.GROUPS.values() for name in names)


def test_missing_programs_are_printed_and_only_fail_if_required(monkeypatch, capsys) -> None:
    monkeypatch.setattr(compilers, "find", lambda name: None if name == "clang" else "/bin/true")
    monkeypatch.setattr(compilers, "_install_debian", lambda packages, deadline: None)
    assert compilers.main(["clang", "gcc"]) == 0
    assert "not on this machine: clang; their tests skip" in capsys.readouterr().err
    assert compilers.main(["clang", "--require"]) == 1


def test_only_what_is_missing_is_installed(monkeypatch) -> None:
    installed: list[str] = []
    monkeypatch.setattr(compilers, "find", lambda name: "/bin/true" if name == "gcc" else None)
    monkeypatch.setattr(compilers, "_install_debian", lambda packages, _: installed.extend(packages))
    monkeypatch.setattr(compilers, "_install_npm", lambda packages, _: installed.extend(packages))
    assert compilers.install(["gcc", "lua5.4", "typescript"]) == ["lua5.4", "typescript"]
    assert installed == ["lua5.4", "typescript@5.9", "@types/node@20"] or installed == [
        "lua5.4",
        "@types/node@20",
        "typescript@5.9",
    ]


def test_an_unknown_name_is_wrong_usage(capsys) -> None:
    with pytest.raises(SystemExit) as stopped:
        compilers.main(["fortran"])
    assert stopped.value.code == 2
    assert "typescript" in capsys.readouterr().err


def test_installations_end_in_time(monkeypatch) -> None:
    started = []
    monkeypatch.setattr(
        compilers.subprocess, "run", lambda command, **settings: started.append(settings["timeout"])
    )
    monkeypatch.setattr(compilers, "monotonic", lambda: 100.0)
    assert compilers._run(["true"], 99.0) is False
    assert started == []
