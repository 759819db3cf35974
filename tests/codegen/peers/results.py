"""The peers: how each is built, run over the corpus, and compared."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack import dialects
from tests.codegen.compilers import needs
from tests.codegen.conformance import Result, run

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = Path(__file__).parent
DEFINITIONS = Path(dialects.__file__).parent / "definitions"


@dataclass(frozen=True)
class Peer:
    """A library and its runner.

    Attributes:
        name: Name of the library.
        command: Builds the runner for a dialect in a folder and returns its command line.
        min_found: Number of messages of common whose packets it finds with the right values.
        min_repacked: Number of messages of common whose packets have the same bytes when packed again.
    """

    name: str
    command: Callable[[str, Path], list[str]]
    min_found: int
    min_repacked: int

    def run(self, dialect: str, folder: Path) -> list[Result]:
        """Build the runner in a folder, and run it over the corpus."""
        return run(self.command(dialect, folder), dialect)


def lines(result: Result, kind: str) -> tuple[list[str], list[str]]:
    """Return the expected and the printed lines of a kind, fields in any order."""
    expected, printed = (
        [" ".join(sorted(line.split())) for line in texts if line.startswith(f"{kind} ")]
        for texts in (result.expected, result.printed)
    )
    return expected, printed


def found(result: Result) -> bool:
    """Return whether the peer found the right packets with the right fields."""
    expected, printed = lines(result, "packet")
    return expected == printed


def repacked(result: Result) -> bool:
    """Return whether the peer also packs the messages to the same bytes."""
    expected, printed = lines(result, "packed")
    return found(result) and expected == printed


def mavgen(language: str, dialect: str, output: Path) -> None:
    """Generate with pymavlink's mavgen from our definitions."""
    command = [sys.executable, "-m", "pymavlink.tools.mavgen", "--no-validate", "--wire-protocol", "2.0"]
    definition = DEFINITIONS / f"{dialect}.xml"
    subprocess.run(
        [*command, "--lang", language, "-o", str(output), str(definition)],
        check=True,
        capture_output=True,
        timeout=100,
    )


def pymavlink(dialect: str, folder: Path) -> list[str]:
    module = folder / f"{dialect}.py"
    mavgen("Python", dialect, module)
    return [sys.executable, str(HERE / "pymavlink_runner.py"), str(module)]


def mavgen_c(dialect: str, folder: Path) -> list[str]:
    mavgen("C", dialect, folder)
    program, header = folder / "runner", f'-DDIALECT_HEADER="{dialect}/mavlink.h"'
    source = HERE / "mavgen_runner.c"
    subprocess.run(
        [needs("gcc"), "-std=gnu11", "-O1", "-w", f"-I{folder}", header, str(source), "-o", str(program)],
        check=True,
        timeout=100,
    )
    return [str(program)]


def node_mavlink(_dialect: str, folder: Path) -> list[str]:
    """Install the package, whose definitions are its own, and run it over the messages that it has."""
    subprocess.run(
        [
            needs("npm"),
            "install",
            "--silent",
            "--no-audit",
            "--no-fund",
            "--prefix",
            str(folder),
            NODE_MAVLINK,
        ],
        check=True,
        timeout=100,
    )
    return [needs("node"), str(HERE / "node_mavlink_runner.mjs"), str(folder)]


def gomavlib(_dialect: str, folder: Path) -> list[str]:
    """Build the runner with the package, whose definitions are its own, from the proxy of Go's modules."""
    shutil.copy(HERE / "gomavlib_runner.go", folder / "main.go")
    for words in (["mod", "init", "peer"], ["get", GOMAVLIB], ["build", "-o", "runner", "."]):
        subprocess.run([needs("go"), *words], cwd=folder, check=True, capture_output=True, timeout=300)
    return [str(folder / "runner")]


NODE_MAVLINK = "node-mavlink@2.3.0"
GOMAVLIB = "github.com/bluenviron/gomavlib/v3@v3.2.0"
PEERS = (
    Peer("pymavlink", pymavlink, min_found=234, min_repacked=182),
    Peer("mavgen C", mavgen_c, min_found=234, min_repacked=234),
    Peer("node-mavlink", node_mavlink, min_found=214, min_repacked=1),
    Peer("gomavlib", gomavlib, min_found=226, min_repacked=226),
)
