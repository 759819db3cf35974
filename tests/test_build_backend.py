"""The build backend: without a Rust toolchain every hook ends with a line on how to install one."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("maturin")

ROOT = Path(__file__).parent.parent
HOOKS = {
    "build_wheel": ("folder",),
    "build_editable": ("folder",),
    "build_sdist": ("folder",),
    "get_requires_for_build_wheel": (),
    "get_requires_for_build_editable": (),
    "get_requires_for_build_sdist": (),
    "prepare_metadata_for_build_wheel": ("folder",),
    "prepare_metadata_for_build_editable": ("folder",),
}


@pytest.fixture
def backend(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "backend"))
    spec = importlib.util.spec_from_file_location("mavstack_build", ROOT / "backend" / "mavstack_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """A folder that is the whole PATH; the returned function adds a program that prints a text."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    for variable in ("MATURIN_NO_INSTALL_RUST", "RUSTUP_AUTO_INSTALL"):
        monkeypatch.setenv(variable, "")  # the backend sets it; the fixture restores it

    def add(name: str, output: str = "", code: int = 0) -> None:
        program = folder / name
        program.write_text(f"#!/bin/sh\necho '{output}'\nexit {code}\n")
        program.chmod(0o755)

    return add


@pytest.mark.parametrize(("hook", "arguments"), HOOKS.items())
def test_every_hook_ends_with_one_line_without_rust(backend, programs, hook, arguments):
    with pytest.raises(SystemExit) as ended:
        getattr(backend, hook)(*arguments)
    assert ended.value.code == (
        "mavstack needs a Rust toolchain, version 1.88 or later, to build: "
        "cargo was not found; install Rust from https://rustup.rs and try again"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
@pytest.mark.parametrize(
    ("output", "code", "problem"),
    [
        ("rustc 1.70.0 (90c541806 2023-05-31)", 0, "rustc 1.70.0 is too old; run `rustup update`"),
        ("rustc 1.9.0", 0, "rustc 1.9.0 is too old"),
        ("error: no default toolchain", 1, "rustc --version failed; run `rustup default stable`"),
        (None, 0, "rustc was not found"),
    ],
)
def test_an_unusable_toolchain_ends_the_build(backend, programs, output, code, problem):
    programs("cargo", "cargo 1.70.0")
    if output is not None:
        programs("rustc", output, code)
    with pytest.raises(SystemExit) as ended:
        backend.get_requires_for_build_wheel()
    assert problem in ended.value.code


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
@pytest.mark.parametrize("version", ["1.88.0", "1.95.0-nightly", "2.0.0"])
def test_a_sufficient_toolchain_is_accepted(backend, programs, version, monkeypatch):
    programs("cargo", f"cargo {version}")
    programs("rustc", f"rustc {version}")
    monkeypatch.setattr(backend.mavstack_station, "requirements", lambda: ["node"])
    assert backend.get_requires_for_build_wheel() == ["node"]
    assert backend.get_requires_for_build_editable() == []
    assert os.environ["MATURIN_NO_INSTALL_RUST"] == "1"


@pytest.mark.skipif(sys.platform == "win32", reason="the programs are shell scripts")
def test_rustup_downloads_no_toolchain(backend, programs, tmp_path):
    programs("cargo")
    programs("rustc")
    downloads = '[ "$RUSTUP_AUTO_INSTALL" = 0 ] && exit 1\necho rustc 1.95.0\n'
    (tmp_path / "bin" / "rustc").write_text(f"#!/bin/sh\n{downloads}")
    with pytest.raises(SystemExit, match="rustc --version failed; run `rustup default stable` and try again"):
        backend.get_requires_for_build_wheel()


@pytest.mark.skipif(shutil.which("make") is None or sys.platform == "win32", reason="needs make")
@pytest.mark.parametrize("target", ["demo", "check"])
def test_make_downloads_nothing_without_rust(tmp_path, target):
    folder = tmp_path / "bin"
    folder.mkdir()
    for program in ("make", "sh", "find", "touch", "mkdir"):
        (folder / program).symlink_to(shutil.which(program))
    (folder / "python3").write_text("#!/bin/sh\nexit 77\n")
    (folder / "python3").chmod(0o755)
    command = ["make", target, f"VENV={tmp_path / 'venv'}"]
    environment = {**os.environ, "PATH": str(folder)}
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, env=environment)
    assert result.returncode != 0
    assert "needs a Rust toolchain, version 1.88 or later: install it from https://rustup.rs" in result.stderr
    assert not (tmp_path / "venv").exists()


def test_pip_shows_the_line_and_no_traceback(tmp_path):
    command = [
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--no-build-isolation",
        "--no-deps",
        "-w",
        tmp_path,
        ROOT,
    ]
    result = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "PATH": str(tmp_path)}
    )
    assert result.returncode != 0
    output = result.stdout + result.stderr
    assert "cargo was not found; install Rust from https://rustup.rs" in output
    assert "Traceback" not in output
    assert "puccinialin" not in output
