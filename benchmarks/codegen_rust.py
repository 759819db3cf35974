"""Generated Rust beside the crate `mavlink` of crates.io.

Both programs in `generated/rust` parse the synthetic flight to typed messages with all fields, and encode
attitudes. cargo compiles them in `.build`, which keeps the compiled crates for the next run. Without cargo,
or if the peer cannot be had, the rows say so.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect

from . import c_library
from .measure import OURS, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .rows import Bench

PEER = "mavlink (crate)"
PEER_VERSION = "=0.21.0"
PROGRAMS = Path(__file__).parent / "generated" / "rust"
MANIFEST = """\
[package]
name = "bench-{name}"
version = "0.1.0"
edition = "2021"

[dependencies]
{dependency}

[workspace]

[profile.release]
lto = true
codegen-units = 1
"""
DEPENDENCIES = {
    "ours": 'mavlink-ardupilotmega = { path = "../library" }',
    # Fields of extensions are read too, as in ours.
    "peer": f'mavlink = {{ version = "{PEER_VERSION}", default-features = false, '
    'features = ["std", "dialect-ardupilotmega", "mav2-message-extensions"] }',
}


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the rows of the parsers and the encoders."""
    folder = c_library.BUILD / "rust"
    library = make_library(Dialect.load(c_library.DIALECT))
    write_files(generate(library, "rust"), folder / "library", overwrite=True)
    programs = {name: _build(folder, name) for name in DEPENDENCIES}
    count = bench.amounts.log
    file = bench.file("flight.bin", lambda: bench.flight.stream)
    for work, mode, amount in (
        ("parse to messages", "parse", count),
        ("fields to packet", "encode", 5 * count),
    ):
        if not all(programs.values()):
            yield Row(f"Rust: {work}", {OURS: "not built", PEER: "not built"}, ())
            continue
        runs = {
            library: partial(_seconds, [str(programs[name]), mode, str(file), str(amount)])
            for library, name in ((OURS, "ours"), (PEER, "peer"))
        }
        results = take_turns(runs, bench.amounts.turns)
        yield Row(f"Rust: {work}", rates(results), (speed_ratio(results, PEER, 1.0),))


def _build(folder: Path, name: str) -> Path | None:
    """Compile a program; None without cargo or its dependencies."""
    cargo = shutil.which("cargo")
    if cargo is None:
        return None
    crate = folder / name
    (crate / "src").mkdir(parents=True, exist_ok=True)
    (crate / "Cargo.toml").write_text(MANIFEST.format(name=name, dependency=DEPENDENCIES[name]))
    shutil.copy(PROGRAMS / f"{name}.rs", crate / "src" / "main.rs")
    target = folder / "target"
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    command = [cargo, "build", "--release", "--quiet"]
    done = subprocess.run(command, cwd=crate, env=environment, capture_output=True, check=False)
    return target / "release" / f"bench-{name}" if done.returncode == 0 else None


def _seconds(command: list[str]) -> float:
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
