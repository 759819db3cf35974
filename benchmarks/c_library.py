"""The C peer: headers that pymavlink's mavgen generates from our definitions, and `peer.c` on top.

Generated files are in `benchmarks/.build`, which git ignores, and are rebuilt when a definition or the
program changed. Without gcc, or if mavgen refuses the definitions, the C column shows the reason.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import io
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from . import workload
from .mix import PROFILES

HERE = Path(__file__).parent
BUILD = HERE / ".build"
DEFINITIONS = HERE.parent / "src" / "mavstack" / "dialects" / "definitions"
DIALECT = "ardupilotmega"
FLAGS = ("-O2", "-std=gnu11", "-w")


class PeerMissingError(Exception):
    """The C peer cannot be built; the text contains the reason."""


@dataclass(frozen=True, slots=True)
class CProgram:
    """The compiled C peer."""

    path: Path
    compiler: str

    def seconds(self, mode: str, count: int, file: Path | None = None) -> float:
        """Run one mode; return the seconds per message that the program measured."""
        arguments = [] if file is None else [str(file)]
        result = subprocess.run(
            [str(self.path), mode, *arguments, str(count)], check=True, capture_output=True, text=True
        )
        messages, took, _ = result.stdout.split()
        if int(messages) != count:
            raise RuntimeError(f"the C library counted {messages} of {count} messages")
        return float(took) / count


def build(definitions: Path) -> CProgram:
    """Generate the headers, write `decode.h`, compile."""
    compiler = shutil.which("gcc")
    if compiler is None:
        raise PeerMissingError("no gcc")
    main = definitions / f"{DIALECT}.xml"
    if not main.exists():
        raise PeerMissingError(f"no {main.name} in {definitions}")
    digest = _digest(definitions)
    target = BUILD / f"c-{digest}"
    program = target / "peer"
    if not program.exists():
        _generate(main, target)
        (target / DIALECT / "decode.h").write_text(_decode_header(target))
        _compile(compiler, target, program)
    version = subprocess.run([compiler, "-dumpfullversion"], check=True, capture_output=True, text=True)
    return CProgram(program, f"gcc {version.stdout.strip()} {FLAGS[0]}")


def build_ours(program: CProgram, folder: Path) -> CProgram:
    """Compile the same program with the headers that `mav gen c` makes of the dialect.

    Args:
        program: The program with mavgen's headers.
        folder: A folder for our headers.
    """
    from mavstack.codegen import generate, make_library, write_files
    from mavstack.dialects import Dialect

    write_files(generate(make_library(Dialect.load(DIALECT)), "c"), folder)
    decode = (program.path.parent / DIALECT / "decode.h").read_text()
    (folder / DIALECT / "decode.h").write_text(decode)
    target = folder / "peer"
    _compile(shutil.which("gcc") or "gcc", folder, target)
    return CProgram(target, program.compiler)


def _digest(definitions: Path) -> str:
    digest = hashlib.sha256()
    sources = [*sorted(definitions.glob("*.xml")), HERE / "peer.c", HERE / "c_library.py", HERE / "mix.py"]
    for source in sources:
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]


def _generate(main: Path, target: Path) -> None:
    for old in BUILD.glob("c-*"):
        shutil.rmtree(old)
    mavgen = importlib.import_module("pymavlink.generator.mavgen")
    options = mavgen.Opts(str(target), wire_protocol="2.0", language="C", validate=False)
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        succeeded = mavgen.mavgen(options, [str(main)])
    if not succeeded:
        raise PeerMissingError(f"mavgen refused {main.name}: {output.getvalue().strip().splitlines()[-1:]}")


def _compile(compiler: str, target: Path, program: Path) -> None:
    command = [compiler, *FLAGS, "-I", str(target / DIALECT), str(HERE / "peer.c"), "-o", str(program), "-lm"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode:
        raise PeerMissingError(f"gcc failed: {result.stderr.strip().splitlines()[:1]}")


def _decode_header(target: Path) -> str:
    key = ", ".join(str(byte) for byte in workload.SIGNING_KEY)
    return "\n".join(
        (
            f"static const uint8_t signing_key[32] = {{{key}}};",
            *_read_three(),
            *_decode_all(target),
            "",
        )
    )


def _read_three() -> list[str]:
    lines = ["static inline double read_three(const mavlink_message_t *message) {"]
    lines.append("switch (message->msgid) {")
    for name, fields in {profile.name: profile.read_fields for profile in PROFILES}.items():
        lower = name.lower()
        terms = " + ".join(_term(name, field) for field in fields)
        lines.append(f"case MAVLINK_MSG_ID_{name}: {{ mavlink_{lower}_t m;")
        lines.append(f"mavlink_msg_{lower}_decode(message, &m); return {terms}; }}")
    return [*lines, "default: return 0.0;", "}", "}"]


def _term(name: str, field: str) -> str:
    message = workload.layout(name)
    is_array = message.array_lengths[message.ordered_fieldnames.index(field)] > 0
    return f"(double)m.{field}" + ("[0]" if is_array else "")


def _decode_all(target: Path) -> list[str]:
    lines = ["static inline void decode_all(const mavlink_message_t *message) {", "switch (message->msgid) {"]
    for header in sorted(target.glob("*/mavlink_msg_*.h")):
        lower = header.stem.removeprefix("mavlink_msg_")
        lines.append(f"case MAVLINK_MSG_ID_{lower.upper()}: {{ mavlink_{lower}_t m;")
        lines.append(f"mavlink_msg_{lower}_decode(message, &m);")
        lines.append('__asm__ volatile("" : : "r"(&m) : "memory"); return; }')
    return [*lines, "}", "}"]
