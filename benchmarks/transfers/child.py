"""The frame of a peer's program: a job on standard input, an answer on standard output, both JSON.

Every peer works in a process of its own, so that one which never returns can be ended, and nothing that one
leaves behind (threads, sessions, imports) is there for the next.
"""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Job(TypedDict):
    """What the program is to know."""

    port: int
    folder: str
    limit: float
    remote_file: str
    plan: list[tuple[int, int, int, int, float]]


class Answer(TypedDict, total=False):
    """What it says: the seconds, and what it got."""

    seconds: float
    problem: str
    parameters: dict[str, float]
    plan: list[tuple[int, int, int, int, float]]


def serve(works: Mapping[str, Callable[[Job], Answer]]) -> None:
    """Do the work that the command line names."""
    job: Job = json.load(sys.stdin)
    told = os.dup(1)
    os.dup2(2, 1)  # what the peer itself prints must not get between
    try:
        answer = works[sys.argv[1]](job)
    except Exception as problem:  # noqa: BLE001 (whatever a peer raises is its answer)
        answer = {"problem": f"{type(problem).__name__}: {problem}".partition("; params")[0][:200]}
    with os.fdopen(told, "w", encoding="utf-8") as out:
        json.dump(answer, out)
    sys.stdout.flush()
    os._exit(0)  # a peer's threads may never end
