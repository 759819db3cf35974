"""Generated Java beside mavgen's, generated Go beside gomavlib, and the time of generation of Java and C#.

The programs in `generated/` parse the synthetic flight to typed messages and encode attitudes, each with one
library. They are compiled in the folder of the run. A compiler or a peer that cannot be had leaves rows out.
"""

from __future__ import annotations

import shutil
import subprocess
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from .codegen_generation import MAVGEN, generation, mavgen_command, our_command
from .measure import OURS, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .rows import Bench

PROGRAMS = Path(__file__).parent / "generated"
DIALECT = "ardupilotmega"
GOMAVLIB = "gomavlib"
GOMAVLIB_VERSION = "v3.2.0"


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the rows of the parsers, the encoders and the generators."""
    yield from _throughput("Java", MAVGEN, _java, bench)
    yield from _throughput("Go", GOMAVLIB, _go, bench)
    for name, language, peer in (("Java", "java", "Java"), ("C#", "csharp", "CS")):
        yield generation(name, language, peer, bench)


def _throughput(
    name: str, peer: str, build: Callable[[Path], dict[str, list[str]] | None], bench: Bench
) -> Iterator[Row]:
    commands = build(bench.folder / name)
    if commands is None:
        yield Row(f"{name}: parse to messages", {OURS: "not built", peer: "not built"}, ())
        return
    count = bench.amounts.fast
    end = int(bench.flight.ends[count - 1])
    file = bench.file("flight-part.bin", lambda: bench.flight.stream[:end])
    for work, mode in (("parse to messages", "parse"), ("fields to packet", "encode")):
        runs = {
            library: partial(_measured, [*command, mode, str(file), str(count)])
            for library, command in commands.items()
        }
        results = take_turns(runs, bench.amounts.turns)
        yield Row(f"{name}: {work}", rates(results), (speed_ratio(results, peer, 1.0),))


def _measured(command: list[str]) -> float:
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def _java(folder: Path) -> dict[str, list[str]] | None:
    """Compile both Java programs; None without a compiler."""
    if shutil.which("javac") is None:
        return None
    commands = {}
    for library, program, generate in (
        (OURS, "Ours", our_command("java", DIALECT)),
        (MAVGEN, "Peer", mavgen_command("Java", DIALECT)),
    ):
        sources, classes = folder / program, folder / f"{program}-classes"
        # mavgen writes the package com.MAVLink into the folder itself.
        subprocess.run([*generate, str(sources)], check=True, capture_output=True)
        files = [
            *sources.rglob("*.java"),
            PROGRAMS / "java" / f"{program}.java",
            PROGRAMS / "java" / "Passes.java",
        ]
        command = ["javac", "-nowarn", "-d", str(classes), *map(str, files)]
        subprocess.run(command, check=True, capture_output=True)
        commands[library] = ["java", "-cp", str(classes), program]
    return commands


def _go(folder: Path) -> dict[str, list[str]] | None:
    """Compile both Go programs; None without a compiler or gomavlib."""
    go = shutil.which("go")
    if go is None:
        return None
    ours, peer = folder / "ours", folder / "peer"
    subprocess.run([*our_command("go", DIALECT), str(ours)], check=True, capture_output=True)
    shutil.copytree(PROGRAMS / "go_ours", ours / "bench")
    shutil.copytree(PROGRAMS / "go_peer", peer)
    module = f"github.com/bluenviron/gomavlib/v3@{GOMAVLIB_VERSION}"
    steps = (
        (ours, ["build", "-o", str(folder / "ours-bench"), "./bench"]),
        (peer, ["mod", "init", "peer"]),
        (peer, ["get", module]),
        (peer, ["build", "-o", str(folder / "peer-bench"), "."]),
    )
    for cwd, words in steps:
        if subprocess.run([go, *words], cwd=cwd, capture_output=True, check=False).returncode:
            return None
    return {OURS: [str(folder / "ours-bench")], GOMAVLIB: [str(folder / "peer-bench")]}
