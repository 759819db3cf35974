"""The PEP 517 build backend: maturin, after a check for a Rust toolchain.

Without `cargo`, maturin downloads a toolchain of several hundred megabytes (by the package puccinialin); so
do the proxies of rustup if its default toolchain is not installed. This backend downloads nothing: the build
ends with one line that says what to install.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tomllib
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import maturin

if TYPE_CHECKING:
    from collections.abc import Callable

_MANIFEST = Path(__file__).parent.parent / "Cargo.toml"


def _with_rust(hook: Callable[..., Any]) -> Callable[..., Any]:
    """Return a PEP 517 hook that checks for a Rust toolchain first."""

    @wraps(hook)
    def checked(*arguments: Any, **keywords: Any) -> Any:  # noqa: ANN401 (the signature of the hook)
        _require_rust()
        return hook(*arguments, **keywords)

    return checked


build_editable = _with_rust(maturin.build_editable)
build_sdist = _with_rust(maturin.build_sdist)
build_wheel = _with_rust(maturin.build_wheel)
get_requires_for_build_editable = _with_rust(maturin.get_requires_for_build_editable)
get_requires_for_build_sdist = _with_rust(maturin.get_requires_for_build_sdist)
get_requires_for_build_wheel = _with_rust(maturin.get_requires_for_build_wheel)
prepare_metadata_for_build_editable = _with_rust(maturin.prepare_metadata_for_build_editable)
prepare_metadata_for_build_wheel = _with_rust(maturin.prepare_metadata_for_build_wheel)


def _require_rust() -> None:
    """End the build with one line unless `cargo` and a sufficient `rustc` are installed."""
    required: str = tomllib.loads(_MANIFEST.read_text("utf-8"))["workspace"]["package"]["rust-version"]
    # This variable disables the download in rustup, of which `cargo` and `rustc` may be proxies.
    os.environ["RUSTUP_AUTO_INSTALL"] = "0"
    problem = _rust_problem(required)
    if problem:
        # SystemExit prints the line alone, where any other exception would print a traceback.
        raise SystemExit(f"mavstack needs a Rust toolchain, version {required} or later, to build: {problem}")
    # This variable disables the download in maturin itself.
    os.environ["MATURIN_NO_INSTALL_RUST"] = "1"


def _rust_problem(required: str) -> str | None:
    """Return why the toolchain cannot build the package and what to do, or None if it can."""
    for program in ("cargo", "rustc"):
        if shutil.which(program) is None:
            return f"{program} was not found; install Rust from https://rustup.rs and try again"
    version = _rustc_version()
    if version is None:
        return "rustc --version failed; run `rustup default stable` and try again"
    if _numbers(version) < _numbers(required):
        return f"rustc {version} is too old; run `rustup update` and try again"
    return None


def _rustc_version() -> str | None:
    """Return the version of the installed compiler, or None if it does not run."""
    command = [shutil.which("rustc") or "rustc", "--version"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 (no input)
    match = re.match(r"rustc (\d+\.\d+(?:\.\d+)?)", result.stdout)
    return match[1] if match and result.returncode == 0 else None


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split(".")))
