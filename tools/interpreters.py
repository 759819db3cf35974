"""The newest Python of this machine that the project supports.

    python -m tools.interpreters      # prints its path if it is newer than the Python that runs this

It is looked for in PATH and in the folders of pyenv and uv. The fast tier runs on it too, with the newest
versions of the dependencies: the default Python of a system may be older than what they support.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

ROOT: Final = Path(__file__).resolve().parents[1]
#: Where version managers keep interpreters, below the home folder.
MANAGED: Final = (".pyenv/versions/*/bin", ".local/share/uv/python/*/bin")
_TIMEOUT: Final = 20
#: Prints the version of a release that can make virtual environments.
_PROGRAM: Final = (
    "import ensurepip, sys, venv; print(*sys.version_info[:2]) if sys.version_info[3] == 'final' else None"
)

Version = tuple[int, int]


def supported(root: Path = ROOT) -> list[Version]:
    """Return the versions of Python that the classifiers of the project name, in ascending order."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    found = (re.fullmatch(r".*:: Python :: (\d+)\.(\d+)", line) for line in project["classifiers"])
    return sorted((int(match[1]), int(match[2])) for match in found if match)


def newest(
    folders: Iterable[Path], versions: Iterable[Version], than: Version = sys.version_info[:2]
) -> Path | None:
    """Return the newest interpreter of some folders.

    Args:
        folders: Folders of programs, such as those of PATH.
        versions: The versions that count.
        than: Only a later version counts.

    Returns:
        The path of the interpreter; None: no folder has a later one that runs.
    """
    places = list(folders)
    for version in sorted(versions, reverse=True):
        if version <= than:
            break
        for folder in places:
            path = folder / f"python{version[0]}.{version[1]}"
            if path.is_file() and _version(path) == version:
                return path
    return None


def folders_of_programs() -> Iterator[Path]:
    """Yield the folders of PATH and of version managers."""
    for name in os.environ.get("PATH", "").split(os.pathsep):
        if name:
            yield Path(name)
    for pattern in MANAGED:
        yield from sorted(Path.home().glob(pattern), reverse=True)


def _version(path: Path) -> Version | None:
    """Return the version of an interpreter; None: it does not run, or it is not a whole release."""
    command = [str(path), "-c", _PROGRAM]
    try:
        result = subprocess.run(  # noqa: S603 (an interpreter of this machine)
            command, capture_output=True, text=True, timeout=_TIMEOUT, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    words = result.stdout.split()
    return (int(words[0]), int(words[1])) if result.returncode == 0 and len(words) == 2 else None


if __name__ == "__main__":
    found = newest(folders_of_programs(), supported())
    if found is not None:
        print(found)
