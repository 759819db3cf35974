"""The entry point of a peer's program: a job on standard input, an answer on standard output, both as JSON.

Every peer runs in a separate process, so that a hanging peer can be killed and no threads, sessions or
imports of one peer affect the next.
"""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Job(TypedDict):
    """The parameters of one transfer."""

    port: int
    folder: str
    timeout: float
    remote_file: str
    plan: list[tuple[int, int, int, int, float]]


class Answer(TypedDict, total=False):
    """The result of one transfer: the seconds, and the received data."""

    seconds: float
    problem: str
    parameters: dict[str, float]
    plan: list[tuple[int, int, int, int, float]]


def serve(works: Mapping[str, Callable[[Job], Answer]]) -> None:
    """Run the work that the command line names."""
    job: Job = json.load(sys.stdin)
    output = os.dup(1)
    os.dup2(2, 1)  # output of the peer itself must not mix with the answer
    try:
        answer = works[sys.argv[1]](job)
    except Exception as problem:  # noqa: BLE001 (every error of a peer is its answer)
        answer = {"problem": f"{type(problem).__name__}: {problem}".partition("; params")[0][:200]}
    with os.fdopen(output, "w", encoding="utf-8") as out:
        json.dump(answer, out)
    sys.stdout.flush()
    os._exit(0)  # threads of a peer may never end
