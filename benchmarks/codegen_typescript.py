"""Generated TypeScript beside npm's node-mavlink and mavgen's TypeScript, and the time of generation.

All three decode the same packets to objects with all fields. mavgen's library reads neither arrays nor
payloads whose zeros were trimmed, so the packets are those without. node-mavlink and ours get 16 KiB chunks,
mavgen's one packet per call. The peers are installed by npm into `.build`.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from functools import partial
from typing import TYPE_CHECKING

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect
from tools.compilers import TOOLS, find, install

from . import c_library
from .codegen_generation import generation
from .measure import OURS, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .rows import Bench

NODE_MAVLINK, MAVGEN = "node-mavlink", "mavgen"
PACKAGES = ("node-mavlink@2.3.0", "@ifrunistuttgart/node-mavlink@0.1.2")
TARGET = 5.0
MAX_PACKETS = 40_000
PROGRAM = c_library.HERE / "codegen_typescript.mjs"
GENERATE = """
import sys
from pymavlink.generator import mavgen
options = mavgen.Opts(sys.argv[2], wire_protocol="2.0", language="TypeScript", validate=False)
mavgen.mavgen(options, [sys.argv[1]])
"""


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the rows of decoding, encoding and generation."""
    if find("typescript") is None:
        install(["typescript"])
    if find("node") is not None and find("typescript") is not None:
        libraries = {OURS: _ours(bench.folder), **_peers()}
        file = bench.file("packets.bin", lambda: _packets(bench))
        count = len(_selected(bench))
        for mode, name in (("decode", "TypeScript: stream to objects"), ("encode", "TypeScript: to packet")):
            work = {
                library: partial(_seconds, library, folder, mode, file, count if mode == "decode" else None)
                for library, folder in libraries.items()
            }
            results = take_turns(work, bench.amounts.turns)
            ratios = tuple(speed_ratio(results, peer, TARGET) for peer in (NODE_MAVLINK, MAVGEN))
            yield Row(name, rates(results), ratios)
    yield generation("TypeScript", "typescript", "TypeScript", bench)
    yield generation("Wireshark", "wireshark", "WLua", bench)


def _selected(bench: Bench) -> list[bytes]:
    dialect = Dialect.load(c_library.DIALECT)
    packets = bench.flight.packets(min(MAX_PACKETS, bench.amounts.log))
    return [packet for packet in packets if _is_simple(dialect, packet)]


def _is_simple(dialect: Dialect, packet: bytes) -> bool:
    definition = dialect.message_definition(int.from_bytes(packet[7:10], "little"))
    arrays = any(field.array_length for field in definition.fields)
    return not arrays and packet[1] == definition.length


def _packets(bench: Bench) -> bytes:
    return b"".join(len(packet).to_bytes(2, "little") + packet for packet in _selected(bench))


def _ours(folder: Path) -> Path:
    target = folder / "typescript"
    write_files(generate(make_library(Dialect.load(c_library.DIALECT)), "typescript"), target)
    _run([find("typescript") or "", "-p", str(target)])
    return target


def _peers() -> dict[str, Path]:
    """Install the peers, and compile the classes that mavgen generates."""
    target = c_library.BUILD / "typescript"
    if not (target / "message-registry.js").exists():
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir(parents=True)
        _run([find("npm") or "npm", "install", "--silent", "--prefix", str(target), *PACKAGES])
        definition = c_library.DEFINITIONS / f"{c_library.DIALECT}.xml"
        _run([sys.executable, "-c", GENERATE, str(definition), str(target)])
        types = ["--types", "node", "--typeRoots", str(TOOLS / "node_modules" / "@types"), "--skipLibCheck"]
        _run([find("typescript") or "", "-p", str(target), *types])
    return {NODE_MAVLINK: target, MAVGEN: target}


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed: {done.stdout[-500:]}{done.stderr[-500:]}")


def _seconds(library: str, folder: Path, mode: str, file: Path, count: int | None) -> float:
    """Run one mode; return the seconds per message that the program measured."""
    command = [find("node") or "node", str(PROGRAM), library, str(folder), mode, str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    messages, took = done.stdout.split()
    if count is not None and int(messages) != count:
        raise RuntimeError(f"{library} counted {messages} of {count} messages")
    return float(took) / int(messages)
