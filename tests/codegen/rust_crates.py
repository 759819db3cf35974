"""Generated crates for the tests: written, with the program of the conformance corpus, and built by cargo."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from mavstack.codegen import generate, write_files
from mavstack.codegen.languages.rust.render import package_name
from mavstack.codegen.languages.rust.types import WIRE_TYPES, identifier, message_types
from tests.codegen.compilers import needs

if TYPE_CHECKING:
    from mavstack.codegen import Library
    from mavstack.dialects.model import FieldDefinition, MessageDefinition

RUNNERS = Path(__file__).parent / "runners" / "rust"
MANIFEST = """\
[package]
name = "runner"
version = "0.1.0"
edition = "2021"

[dependencies]
{name} = {{ path = "../{name}" }}

[workspace]

[profile.dev]
debug = false
"""


def write_crate(library: Library, folder: Path) -> Path:
    """Write the crate of a library below a folder, and return its own folder."""
    crate = folder / package_name(library)
    write_files(generate(library, "rust"), crate)
    return crate


def write_program(crate: Path, source: str) -> Path:
    """Write a program that uses a crate beside it, and return its folder."""
    folder = crate.parent / "runner"
    (folder / "src").mkdir(parents=True, exist_ok=True)
    (folder / "Cargo.toml").write_text(MANIFEST.format(name=crate.name))
    (folder / "src" / "main.rs").write_text(source)
    return folder


def write_runner(library: Library, crate: Path) -> Path:
    """Write the runner of the conformance corpus, and return its folder."""
    environment = Environment(
        loader=FileSystemLoader(RUNNERS), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    types = message_types(library)
    messages = [{"type": types[item.name], "fields": _fields(item)} for item in library.messages]
    crate_name = crate.name.replace("-", "_")
    return write_program(
        crate, environment.get_template("main.rs.j2").render(crate=crate_name, messages=messages)
    )


def _fields(message: MessageDefinition) -> list[dict[str, str]]:
    return [{"official": item.name, "value": _value(item)} for item in message.fields]


def _value(item: FieldDefinition) -> str:
    """Return the expression of a field's value as its wire type."""
    value = f"m.{identifier(item.name)}"
    if not item.enum:
        return value
    number = WIRE_TYPES[item.type]
    return f"{value}.map(|value| value.0 as {number})" if item.array_length else f"({value}.0 as {number})"


def cargo(folder: Path, *words: str) -> None:
    """Run cargo in a folder without network, with warnings as errors."""
    target = str(folder.parent / "target")
    environment = {
        **os.environ,
        "CARGO_TARGET_DIR": target,
        "RUSTFLAGS": "-D warnings",
        "RUSTDOCFLAGS": "-D warnings",
    }
    finished = subprocess.run(
        [needs("cargo"), *words, "--offline", "--quiet"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr[-4000:]
