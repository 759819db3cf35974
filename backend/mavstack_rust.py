"""Finds the Rust toolchain of a build, and gets one into the folder of the project where the system has none.

    python backend/mavstack_rust.py                          # have a toolchain, before make installs anything
    python backend/mavstack_rust.py cargo clippy --quiet     # run a program of the toolchain

A toolchain of the system is used as it is. Without one, or with one that is too old, a minimal toolchain is
installed below `.tools/rust` by the package puccinialin, which maturin itself uses; a line says so first.
Nothing outside the project changes: crates are kept there too. `MAVSTACK_NO_DOWNLOAD=1` refuses the download,
and the build ends with one line, as it does where the download cannot be reached.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
#: The package that gets a toolchain.
REQUIREMENT: Final = "puccinialin>=0.1.5"
_MODULE: Final = "puccinialin"
_REFUSAL: Final = "MAVSTACK_NO_DOWNLOAD"
#: Components by the subcommand of cargo that needs them; the minimal profile has none of them.
_COMPONENTS: Final = {"clippy": "clippy", "fmt": "rustfmt"}
_SIZE: Final = "about 130 MB, 600 MB unpacked"


class RustError(Exception):
    """There is no sufficient toolchain; the text says why, and what to do."""


def required_version(root: Path = ROOT) -> str:
    """Return the oldest version of Rust that compiles the project."""
    # Not by tomllib: make runs this by the Python of the system, which may be too old for the project.
    found = re.search(r'^rust-version = "([\d.]+)"', (root / "Cargo.toml").read_text("utf-8"), re.MULTILINE)
    return found[1] if found else ""


def problem(root: Path = ROOT) -> str | None:
    """Return why the toolchain in PATH cannot build the package and what to do, or None if it can."""
    for program in ("cargo", "rustc"):
        if shutil.which(program) is None:
            return f"{program} was not found; install Rust from https://rustup.rs and try again"
    version = _rustc_version()
    if version is None:
        return "rustc --version failed; run `rustup default stable` and try again"
    if _numbers(version) < _numbers(required_version(root)):
        return f"rustc {version} is too old; run `rustup update` and try again"
    return None


def needs_download(root: Path = ROOT) -> bool:
    """Use the toolchain of the system or of the project; return whether there is neither.

    Raises:
        RustError: There is none, and the user refused the download.
    """
    # This variable disables the download in rustup, of which `cargo` and `rustc` may be proxies.
    os.environ["RUSTUP_AUTO_INSTALL"] = "0"
    found = problem(root)
    if found is None or _use_own(root):
        return False
    if os.environ.get(_REFUSAL, "") not in ("", "0"):
        raise RustError(_line(found, root))
    return True


def provide(root: Path = ROOT) -> None:
    """Have a toolchain in PATH: the one of the system, or one below the project, downloaded if need be.

    Raises:
        RustError: There is none, and it cannot be downloaded.
    """
    if not needs_download(root):
        return
    found = problem(root) or ""
    _announce(
        f"mavstack: {found.partition(';')[0]}: downloading a Rust toolchain ({_SIZE}) into"
        f" {folder(root)}; {_REFUSAL}=1 refuses it"
    )
    try:
        _download(root)
    except Exception as error:
        raise RustError(f"{_line(found, root)} (the download failed: {_brief(error)})") from error
    if not _use_own(root):
        raise RustError(f"{_line(found, root)} (the downloaded toolchain does not run)")


def folder(root: Path = ROOT) -> Path:
    """Return the folder of the project's own toolchain."""
    return root / ".tools" / "rust"


def _line(found: str, root: Path) -> str:
    return f"mavstack needs a Rust toolchain, version {required_version(root)} or later, to build: {found}"


def _use_own(root: Path) -> bool:
    """Put the project's own toolchain first in PATH if it is sufficient; return whether it is."""
    own = folder(root)
    if not (own / "cargo" / "bin").is_dir():
        return False
    before = dict(os.environ)
    os.environ.update(
        RUSTUP_HOME=str(own / "rustup"),
        CARGO_HOME=str(own / "cargo"),
        PATH=f"{own / 'cargo' / 'bin'}{os.pathsep}{before.get('PATH', '')}",
    )
    if problem(root) is None:
        return True
    os.environ.clear()
    os.environ.update(before)
    return False


def _announce(line: str) -> None:
    """Print a line for the user, also where pip keeps the output of builds to itself."""
    print(line, file=sys.stderr, flush=True)
    if not sys.stderr.isatty() and "MAKELEVEL" not in os.environ:
        with contextlib.suppress(OSError), Path("/dev/tty").open("w") as terminal:
            terminal.write(f"\r{line}\n")


def _download(root: Path) -> None:
    """Install a toolchain below the project."""
    own = folder(root)
    own.mkdir(parents=True, exist_ok=True)
    # A toolchain of the system that is too old is no obstacle; one that is named applies to that one.
    environment = {"RUSTUP_INIT_SKIP_PATH_CHECK": "yes"}
    named = os.environ.pop("RUSTUP_TOOLCHAIN", None)
    os.environ.update(environment)
    try:
        if importlib.util.find_spec(_MODULE) is not None:
            _run_installer([sys.executable], own)
        else:
            _download_by_a_separate_environment(own)
    finally:
        if named is not None:
            os.environ["RUSTUP_TOOLCHAIN"] = named


def _download_by_a_separate_environment(own: Path) -> None:
    """Install puccinialin for this one call: make has no environment yet."""
    place = own / "installer"
    programs = place / ("Scripts" if os.name == "nt" else "bin")
    try:
        _check([sys.executable, "-m", "venv", str(place)])
        _check([str(programs / "python"), "-m", "pip", "install", "--quiet", REQUIREMENT])
        _run_installer([str(programs / "python")], own)
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _run_installer(python: list[str], own: Path) -> None:
    _check([*python, "-m", _MODULE, "--location", str(own), "--info-json", str(own / "environment.json")])


def _check(command: list[str]) -> None:
    """Run a program; its output is the error if it fails."""
    result = subprocess.run(  # noqa: S603 (words of this module)
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if result.returncode != 0:
        raise RustError(result.stdout)


def _brief(error: Exception) -> str:
    """Return the last line of an error, which names it in a traceback."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[-1] if lines else type(error).__name__


def _rustc_version() -> str | None:
    """Return the version of the installed compiler, or None if it does not run."""
    command = [shutil.which("rustc") or "rustc", "--version"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 (no input)
    match = re.match(r"rustc (\d+\.\d+(?:\.\d+)?)", result.stdout)
    return match[1] if match and result.returncode == 0 else None


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split(".")))


def _run(words: list[str], root: Path) -> int:
    """Run a program of the toolchain; a component that the project's own one lacks is added first."""
    if os.environ.get("CARGO_HOME") == str(folder(root) / "cargo"):
        needed = [name for name in words if name in _COMPONENTS]
        for name in needed:
            _check([shutil.which("rustup") or "rustup", "component", "add", _COMPONENTS[name]])
    command = [shutil.which(words[0]) or words[0], *words[1:]]
    return subprocess.run(command, check=False).returncode  # noqa: S603 (words of the Makefile)


def main(words: list[str] | None = None, root: Path = ROOT) -> int:
    """Have a toolchain, and run a program of it; return the exit code."""
    words = sys.argv[1:] if words is None else words
    try:
        provide(root)
        return _run(words, root) if words else 0
    except RustError as error:
        print(error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
