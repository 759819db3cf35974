"""The conversion of many logs: in this process, in several ones, or on the workers of a Dask cluster.

A job is the conversion of one log; jobs do not know each other. `--resume` keeps a file with a line for each
log that was converted, so that a run that was interrupted continues with the others.
"""

from __future__ import annotations

import json
import os
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, as_completed
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from mavstack.cli.common.errors import failure_text
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.data.opening import open_file
from mavstack.cli.data.remote import is_remote, local_copy, local_result
from mavstack.errors import LogError, MavstackError, MissingExtraError
from mavstack.logs.export import ExportOptions, export_log, exporter

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.logs.export import LogExporter

#: The MCAP profile with the same topics as the bridge to ROS 2.
ROS2: Final = "ros2"
_KILLED: Final = "a process was killed, perhaps for its memory; try --jobs 1"


class Job(NamedTuple):
    """The conversion of one log."""

    source: str
    target: str


class Outcome(NamedTuple):
    """The result of a job: what was written as values for JSON, and the problem if it failed."""

    job: Job
    written: dict[str, Any]
    skipped: str
    problem: str = ""


class ConvertedLogs:
    """The file of `--resume`: the logs that were converted, each with its size and its time of change."""

    def __init__(self, path: str) -> None:
        self._path = Path(path)
        try:
            data = self._path.read_bytes() if self._path.exists() else b""
            # A conversion that was killed may have left an incomplete last line.
            complete = data[: data.rfind(b"\n") + 1]
            self._known = {tuple(json.loads(line)) for line in complete.decode().splitlines()}
            if len(complete) < len(data):
                os.truncate(self._path, len(complete))
        except (OSError, ValueError, TypeError) as error:
            raise LogError(f"cannot read {path}: it is no list of converted logs ({error})") from error

    def has(self, job: Job) -> bool:
        """Return whether a log was converted, and has not changed since."""
        return self._entry(job) in self._known

    def add(self, job: Job) -> None:
        """Add a log, in the hands of the system at once."""
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(self._entry(job)) + "\n")
        except OSError as error:
            raise LogError(f"cannot write {self._path}: {error.strerror or error}") from error

    def _entry(self, job: Job) -> tuple[str, str, int, int]:
        if is_remote(job.source):
            return job.source, job.target, 0, 0
        status = Path(job.source).stat() if Path(job.source).exists() else None
        size, changed = (status.st_size, status.st_mtime_ns) if status is not None else (0, 0)
        return job.source, job.target, size, changed


def chosen_exporter(arguments: Namespace) -> LogExporter:
    """Return the format of `--to`, in the profile of `--profile`."""
    if arguments.profile == ROS2:
        from mavstack.bridges.mcap.log_export import ROS2_MCAP

        return ROS2_MCAP
    return exporter(arguments.to)


def run_jobs(jobs: Sequence[Job], arguments: Namespace) -> Iterator[Outcome]:
    """Run jobs, and yield their outcomes as they end.

    Raises:
        LogError: The Dask cluster cannot be reached; or, if there is only one job, that one failed.
        MissingExtraError: Dask is not installed.
    """
    if arguments.dask is not None:
        yield from _on_dask(jobs, arguments)
    elif len(jobs) == 1:
        with TransferProgress(f"converting {jobs[0].source}") as progress:
            yield _convert(jobs[0], arguments, progress)
    elif jobs:
        yield from _in_processes(jobs, arguments)


def _in_processes(jobs: Sequence[Job], arguments: Namespace) -> Iterator[Outcome]:
    workers = min(arguments.jobs or os.cpu_count() or 1, len(jobs))
    # Processes are spawned: a forked process would inherit the threads of pyarrow in an undefined state.
    with (
        TransferProgress(f"converting {len(jobs)} logs", in_bytes=False) as progress,
        ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool,
    ):
        running = {pool.submit(convert_log, job, arguments): job for job in jobs}
        try:
            for done, future in enumerate(as_completed(running), 1):
                progress(done, len(jobs))
                try:
                    yield future.result()
                except BrokenExecutor:
                    problem = f"cannot convert {running[future].source}: {_KILLED}"
                    yield Outcome(running[future], {}, "", problem)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _on_dask(jobs: Sequence[Job], arguments: Namespace) -> Iterator[Outcome]:
    """Run jobs on the workers of a cluster, which see the same files and have Mavstack installed."""
    try:
        distributed = import_module("distributed")
    except ImportError:
        raise MissingExtraError("conversion on a Dask cluster", "dask") from None
    try:
        client = distributed.Client(arguments.dask, timeout=10)
    except (OSError, ValueError) as error:
        raise LogError(f"cannot reach the Dask scheduler {arguments.dask}: {error}") from error
    with client, TransferProgress(f"converting {len(jobs)} logs", in_bytes=False) as progress:
        futures = [client.submit(convert_log, job, arguments, pure=False) for job in jobs]
        for done, (_, outcome) in enumerate(distributed.as_completed(futures, with_results=True), 1):
            progress(done, len(jobs))
            yield outcome


def convert_log(job: Job, arguments: Namespace) -> Outcome:
    """Convert one log; a failure is part of the outcome."""
    try:
        return _convert(job, arguments, None)
    except (MavstackError, OSError) as error:
        return Outcome(job, {}, "", failure_text(error))


def _convert(job: Job, arguments: Namespace, progress: Callable[[int, int], None] | None) -> Outcome:
    # pyarrow reads this variable when it is imported: its default pool keeps tens of megabytes per thread.
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
    options = ExportOptions(scaled=arguments.scaled, enums=arguments.enums, raw_text=arguments.raw_text)
    names = [name.strip() for name in arguments.only.split(",")] if arguments.only else ()
    with (
        local_copy(job.source) as source,
        local_result(job.target) as target,
        open_file(source, arguments) as log,
    ):
        summary = export_log(
            log, chosen_exporter(arguments), target, names=names, options=options, progress=progress
        )
    damage = summary.skipped
    return Outcome(job, summary.to_dict(), damage.describe() if damage else "")
