"""Compilers, browsers and other programs that tests need, from the machine, Debian and npm.

    python -m tools.compilers NAME…       # install what is missing; `test`, `interop`, `nightly` are groups
    python -m tools.compilers --list

A program that is already there is used as it is. Debian packages are installed only by root, npm packages
into the folder `.tools`. Programs that cannot be had are named, and their tests skip; the exit code is then 1
with `--require`.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT: Final = Path(__file__).resolve().parents[1]
TOOLS: Final = ROOT / ".tools"
#: Folders where programs are that are not in PATH.
FOLDERS: Final = (
    TOOLS / "node_modules" / ".bin",
    Path("/usr/local/go/bin"),
    Path("/usr/share/dotnet"),
    Path("/usr/lib/dotnet"),
    Path("/opt/swift/usr/bin"),
)
#: Seconds that all installations together may take; the tests of what is missing then skip.
INSTALL_TIMEOUT: Final = 300


@dataclass(frozen=True)
class Program:
    """A program, and the packages that contain it.

    Attributes:
        executables: Names of the executable; the first one that is there counts.
        debian: Debian packages.
        npm: npm packages with versions.
        files: Patterns of further files that must exist.
        module: Path below `.tools` of a module that takes the place of an executable.
    """

    executables: tuple[str, ...]
    debian: tuple[str, ...] = ()
    npm: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    module: str = ""


_MICROPYTHON: Final = "node_modules/@micropython/micropython-webassembly-pyscript/micropython.mjs"

PROGRAMS: Final = {
    "gcc": Program(("gcc",), ("gcc", "libc6-dev")),
    "g++": Program(("g++",), ("g++",)),
    "clang": Program(("clang",), ("clang",)),
    "cmake": Program(("cmake",), ("cmake",)),
    # gcc-multilib itself conflicts with the cross compilers.
    "gcc-multilib": Program(
        ("gcc",),
        ("lib32gcc-12-dev", "lib32stdc++-12-dev", "libc6-dev-i386"),
        files=("/usr/lib/gcc/x86_64-linux-gnu/*/32/libgcc.a", "/usr/include/gnu/stubs-32.h"),
    ),
    "powerpc-gcc": Program(
        ("powerpc-linux-gnu-gcc",),
        ("gcc-powerpc-linux-gnu", "libc6-dev-powerpc-cross"),
        files=("/usr/powerpc-linux-gnu/include/stdint.h",),
    ),
    "s390x-gcc": Program(
        ("s390x-linux-gnu-gcc",),
        ("gcc-s390x-linux-gnu", "libc6-dev-s390x-cross"),
        files=("/usr/s390x-linux-gnu/include/stdint.h",),
    ),
    "qemu-ppc": Program(("qemu-ppc-static", "qemu-ppc"), ("qemu-user-static",)),
    "qemu-s390x": Program(("qemu-s390x-static", "qemu-s390x"), ("qemu-user-static",)),
    "arm-none-eabi-gcc": Program(("arm-none-eabi-gcc",), ("gcc-arm-none-eabi", "libnewlib-arm-none-eabi")),
    "java": Program(("javac",), ("default-jdk-headless",)),
    "go": Program(("go",), ("golang-go",)),
    "cargo": Program(("cargo",), ("cargo",)),
    "node": Program(("node",), ("nodejs",)),
    "npm": Program(("npm",), ("npm",)),
    "typescript": Program(("tsc",), npm=("typescript@5.9", "@types/node@20")),
    "lua5.3": Program(("lua5.3",), ("lua5.3",)),
    "lua5.4": Program(("lua5.4",), ("lua5.4",)),
    "luac5.3": Program(("luac5.3",), ("lua5.3",)),
    "luac5.4": Program(("luac5.4",), ("lua5.4",)),
    "luajit": Program(("luajit",), ("luajit",)),
    "luacheck": Program(("luacheck",), ("lua-check",)),
    "tshark": Program(("tshark",), ("tshark",)),
    "dotnet": Program(("dotnet",), ("dotnet-sdk-8.0",)),
    "mono": Program(("mcs",), ("mono-mcs", "mono-runtime", "libmono-system-core4.0-cil")),
    "swift": Program(("swiftc",), ("swiftlang",)),
    "chromium": Program(("chromium", "chromium-browser", "google-chrome"), ("chromium",)),
    # MicroPython for WebAssembly: a module for Node.
    "micropython": Program(
        (), npm=("@micropython/micropython-webassembly-pyscript@1.27",), module=_MICROPYTHON
    ),
}

_TEST: Final = ("typescript", "lua5.4")
_INTEROP: Final = (*_TEST, "clang", "lua5.3", "luajit", "tshark", "mono", "chromium")
_NIGHTLY: Final = (
    *_INTEROP,
    "gcc-multilib",
    "powerpc-gcc",
    "s390x-gcc",
    "qemu-ppc",
    "qemu-s390x",
    "arm-none-eabi-gcc",
    "luacheck",
    "micropython",
)
#: Programs that each tier of tests needs apart from gcc, Java, Go, Rust and Node.
GROUPS: Final = {"test": _TEST, "interop": _INTEROP, "nightly": _NIGHTLY}


def find(name: str) -> str | None:
    """Return the path of a program.

    Args:
        name: Name of the program in `PROGRAMS`, such as "clang".

    Returns:
        The path, or None if the program is not on this machine.
    """
    program = PROGRAMS[name]
    if not all(any(Path("/").glob(pattern.lstrip("/"))) for pattern in program.files):
        return None
    if program.module:
        return str(TOOLS / program.module) if (TOOLS / program.module).is_file() else None
    path = os.pathsep.join(
        [str(TOOLS / "node_modules" / ".bin"), os.environ.get("PATH", ""), *map(str, FOLDERS)]
    )
    found = (shutil.which(executable, path=path) for executable in program.executables)
    return next((item for item in found if item), None)


def install(names: Iterable[str]) -> list[str]:
    """Install programs that are missing.

    Args:
        names: Names of programs in `PROGRAMS`.

    Returns:
        The names of the programs that cannot be had.
    """
    missing = [name for name in names if find(name) is None]
    debian = sorted({package for name in missing for package in PROGRAMS[name].debian})
    npm = sorted({package for name in missing for package in PROGRAMS[name].npm})
    deadline = monotonic() + INSTALL_TIMEOUT
    if debian:
        _install_debian(debian, deadline)
    if npm:
        _install_npm(npm, deadline)
    return [name for name in missing if find(name) is None]


def _install_debian(packages: list[str], deadline: float) -> None:
    """Install Debian packages; one that does not exist prevents none of the others."""
    apt = shutil.which("apt-get")
    if apt is None or os.geteuid() != 0:
        return
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    command = [apt, "-qq", "install", "--yes", "--no-install-recommends"]
    if _run([*command, *packages], deadline, environment):
        return
    _run([apt, "-qq", "update"], deadline, environment)
    if not _run([*command, *packages], deadline, environment):
        for package in packages:
            _run([*command, package], deadline, environment)


def _install_npm(packages: list[str], deadline: float) -> None:
    npm = find("npm")
    if npm is not None:
        TOOLS.mkdir(exist_ok=True)
        options = ("--silent", "--no-audit", "--no-fund", "--prefix", str(TOOLS))
        _run([npm, "install", *options, *packages], deadline)


def _run(command: list[str], deadline: float, environment: dict[str, str] | None = None) -> bool:
    """Return whether a command succeeds before a time of `monotonic`."""
    left = deadline - monotonic()
    if left <= 0:
        return False
    try:
        finished = subprocess.run(  # noqa: S603 (commands of this module)
            command,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=left,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return finished.returncode == 0


def main(words: list[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.compilers", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="programs, or a tier of tests")
    parser.add_argument("--list", action="store_true", help="list the programs with their paths")
    parser.add_argument("--require", action="store_true", help="exit with 1 if a program cannot be had")
    arguments = parser.parse_args(words)
    if arguments.list:
        for name in PROGRAMS:
            print(f"{name:<18} {find(name) or '-'}")
        return 0
    names = [name for word in arguments.names for name in GROUPS.get(word, (word,))]
    unknown = [name for name in names if name not in PROGRAMS]
    if unknown or not names:
        parser.error(f"name programs or tiers: {', '.join([*GROUPS, *PROGRAMS])}")
    missing = install(names)
    if missing:
        print(f"not on this machine: {', '.join(missing)}; their tests skip", file=sys.stderr)
    return 1 if missing and arguments.require else 0


if __name__ == "__main__":
    sys.exit(main())
