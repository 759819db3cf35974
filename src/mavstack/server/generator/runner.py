"""The generator of a station: one process at a time, few forms that wait.

A generation takes seconds of processor time. In a process it delays no vehicle, and one that takes too much
time or memory ends without the station.
"""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from mavstack.http.bodies import RefusedError
from mavstack.server.generator.work import ARCHIVE

if TYPE_CHECKING:
    from mavstack.server.generator.work import Work

#: Maximum number of forms that are executed or wait.
MAX_FORMS: Final = 4
#: Timeout of one form in seconds.
TIMEOUT: Final = 40.0
_COMMAND: Final = ("-m", "mavstack.server.generator.work")


class Generated(NamedTuple):
    """The result of a form: the problem of each entry, the commands that do the same, and the ZIP file."""

    problems: dict[str, str]
    commands: list[str]
    archive: bytes = b""


class GeneratorRunner:
    """Carries out forms, one after the other."""

    def __init__(self) -> None:
        self._forms = 0
        self._turn = asyncio.Lock()

    async def run(self, work: Work, definition: bytes = b"") -> Generated:
        """Carry out a form.

        Args:
            work: The form.
            definition: The content of its definition file; empty: it has none.

        Returns:
            The result.

        Raises:
            RefusedError: Too many forms wait, the form has a problem, or the generation exceeds its limits.
        """
        if self._forms >= MAX_FORMS:
            raise RefusedError(429, f"{MAX_FORMS} libraries are generated already: try again later")
        self._forms += 1
        try:
            async with self._turn:
                with TemporaryDirectory(prefix="mavstack-") as folder:
                    return await self._run(work, definition, Path(folder))
        finally:
            self._forms -= 1

    async def _run(self, work: Work, definition: bytes, folder: Path) -> Generated:
        if work.file:
            (folder / work.file).write_bytes(definition)
        answer = await asyncio.to_thread(_answer_of, work, folder)
        if "refused" in answer:
            raise RefusedError(400, answer["refused"])
        archive = (folder / ARCHIVE).read_bytes() if work.archive else b""
        return Generated(answer["problems"], answer["commands"], archive)


def _answer_of(work: Work, folder: Path) -> dict[str, Any]:
    """Run the process, and return its answer."""
    paths = os.pathsep.join(filter(None, sys.path))
    try:
        done = subprocess.run(  # noqa: S603 (our own module)
            [sys.executable, *_COMMAND],
            input=work.to_json(),
            cwd=folder,
            env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
            timeout=TIMEOUT,
            capture_output=True,
            check=True,
        )
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
        raise RefusedError(
            413, "the generation exceeds the limits on its time and memory: select messages with `only`"
        ) from None
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer
