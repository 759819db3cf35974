"""Modules are small, docstrings begin with a noun or a verb, and test modules mirror source modules."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]
FOLDERS = ("src", "tests", "tools", "benchmarks", "examples")
MODULES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
#: Sources of the browser ground station, without what is generated.
STATION_MODULES = sorted(
    path
    for path in (ROOT / "web" / "src").rglob("*")
    if path.suffix in {".ts", ".svelte", ".css"} and "generated" not in path.parts
)
TEST_MODULES = sorted((ROOT / "tests").rglob("test_*.py"))
MAX_MODULE_LINES, MAX_FACADE_LINES, MAX_FUNCTION_LINES = 400, 600, 60
#: Modules of one class each: the parts and calls of a whole package, with their contracts.
FACADES = {
    "src/mavstack/logs/log.py",
    "src/mavstack/node/camera.py",
    "src/mavstack/node/component.py",
    "src/mavstack/node/node.py",
    "src/mavstack/vehicle/vehicle.py",
}

#: Folders of tests by subject.
SUBJECT_FOLDERS = {
    "attacks",
    "codegen/peers",
    "docs",
    "interop",
    "realdata",
    "robustness",
    "sim/failsafes",
    "sim/robustness",
    "sim/whole_flights",
    "tools",
    "typing",
    "vehicle/failures",
}
#: Tests of a whole package by method: in any folder.
METHODS = {"client_server", "pitfalls", "properties", "pymavlink", "random", "robustness"}
#: Tests of a package by subject.
SUBJECTS = {
    ".": {"api_docs", "build_backend", "build_station", "examples", "sharing"},
    "codegen": {"conformance"},
    "codegen/languages": {"awkward", "foreign_enums", "signs"},
    "cli": {"help", "process", "realdata", "redaction"},
    "cli/vehicle": {"modes"},
    "files/parameter_metadata": {"formats"},
    "files/parameters": {"formats"},
    "files/plans": {"plan_cases", "round_trips"},
    "logs/packets": {"recordings"},
    "node": {"both_drivers", "closing", "lossy_streams", "random_unplugging"},
    "router": {"cases", "quarantine_reload"},
    "router/firewall/detectors": {"flights"},
    "services": {"vectors"},
    "services/ftp": {"interruptions", "radio"},
    "services/mission": {"autopilots", "goals"},
    "services/parameters": {"pauses"},
    "sim": {"link_settings"},
    "sim/ardupilot": {"home_item", "quadplane"},
    "sim/autopilot/mission": {"flights"},
    "sim/px4": {"mission_end", "offboard"},
    "sim/storage": {"log_downloads"},
    "sync": {"vehicle"},
    "vehicle": {"arguments", "empty_missions", "flying", "modes", "quadplane", "whole_missions"},
    "wire": {
        "core_docs",
        "fields_json",
        "object_lifetime",
        "parser_properties",
        "signing",
        "signing_pitfalls",
        "sub_interpreters",
    },
}


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def mirrors_source(path: Path) -> bool:
    """Return whether `test_<name>.py` or `test_<name>_<subject>.py` has a source `<name>`."""
    folder = path.parent.relative_to(ROOT / "tests")
    source = ROOT / "src" / "mavstack" / folder
    words = path.stem.removeprefix("test_").split("_")
    names = ("_".join(words[:count]) for count in range(1, len(words) + 1))
    is_package = "_".join(words) == folder.name and source.is_dir()
    return is_package or any((source / f"{name}.py").exists() or (source / name).is_dir() for name in names)


def is_subject(path: Path) -> bool:
    folder = path.parent.relative_to(ROOT / "tests").as_posix()
    name = path.stem.removeprefix("test_")
    in_folder = any(f"{folder}/".startswith(f"{subject}/") for subject in SUBJECT_FOLDERS)
    return in_folder or name in METHODS or name in SUBJECTS.get(folder, ())


def is_long(text: str) -> bool:
    """Return whether a module may have a long function: the formatter puts two blank lines before each."""
    return any(part.count("\n") >= MAX_FUNCTION_LINES for part in re.split(r"\n\n\n(?=\S)", text))


def definitions(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a module, and the classes and functions in it (expressions are not searched: there are many)."""
    if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
        yield node
    for name in ("body", "orelse", "handlers", "finalbody"):
        for part in getattr(node, name, ()):
            if isinstance(part, ast.stmt | ast.excepthandler):
                yield from definitions(part)


def test_test_modules_mirror_source_modules() -> None:
    others = {name_of(path) for path in TEST_MODULES if not mirrors_source(path) and not is_subject(path)}
    assert others == set(), "name them after their source modules, or add their subjects to this file"


def test_listed_subjects_exist() -> None:
    assert all((ROOT / "tests" / folder).is_dir() for folder in SUBJECT_FOLDERS)
    listed = {ROOT / "tests" / folder / f"test_{name}.py" for folder in SUBJECTS for name in SUBJECTS[folder]}
    assert {name_of(path) for path in listed - set(TEST_MODULES)} == set()


def test_modules_are_short() -> None:
    lengths = {
        name_of(path): len(path.read_text("utf-8").splitlines()) for path in (*MODULES, *STATION_MODULES)
    }
    assert lengths.keys() >= FACADES
    limits = dict.fromkeys(FACADES, MAX_FACADE_LINES)
    too_long = {name for name, length in lengths.items() if length > limits.get(name, MAX_MODULE_LINES)}
    assert {name: lengths[name] for name in too_long} == {}


def test_functions_are_short() -> None:
    long = {
        f"{name_of(path)}:{node.name}": length
        for path in MODULES
        if is_long(text := path.read_text("utf-8"))
        for node in definitions(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (length := (node.end_lineno or 0) - node.lineno + 1) > MAX_FUNCTION_LINES
    }
    assert long == {}


def test_docstrings_begin_with_a_noun_or_a_verb() -> None:
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    unclear = [
        f"{name_of(path)}: {found.splitlines()[0]}"
        for path in MODULES
        if re.search(r"[\"']\s*(What|Whether) ", text := path.read_text("utf-8"))
        for node in definitions(ast.parse(text))
        if isinstance(node, documented)
        and (found := ast.get_docstring(node) or "").startswith(("What ", "Whether "))
    ]
    assert unclear == []
