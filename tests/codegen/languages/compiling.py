"""Generated C and C++ libraries in a folder, and programs that are compiled with them."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect

if TYPE_CHECKING:
    from collections.abc import Iterable

RUNNERS = Path(__file__).parents[1] / "runners"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
C99 = ("-std=c99", *WARNINGS)


def write_library(language: str, dialect: str | Path, folder: Path, only: Iterable[str] = ()) -> Path:
    """Generate the library of an official dialect or of a file into a folder, and return the folder."""
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else Dialect.from_xml(dialect)
    write_files(generate(make_library(loaded, only=only), language), folder)
    return folder


def build(compiler: str, source: Path, program: Path, *flags: str) -> Path:
    """Compile a program against the headers beside it; its warnings are errors."""
    command = [compiler, *flags, f"-I{program.parent}", str(source), "-o", str(program), "-lm"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    assert finished.returncode == 0, finished.stderr[:3000]
    return program


def build_runner(compiler: str, dialect: str, folder: Path, *flags: str) -> Path:
    """Compile the conformance runner of the C library that is in a folder."""
    names = Dialect.load(dialect).names
    lines = "".join(f"MESSAGE({name}, {name.lower()})\n" for name in names)
    (folder / "messages.inc").write_text(lines)
    header = f'-DDIALECT_HEADER="{dialect}/mavlink.h"'
    return build(compiler, RUNNERS / "c" / "runner.c", folder / "runner", *C99, header, *flags)


def run(*command: str | Path) -> str:
    """Run a program and return its output."""
    finished = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=100, check=False)
    assert finished.returncode == 0, finished.stderr[-3000:] or finished.stdout[-3000:]
    return finished.stdout
