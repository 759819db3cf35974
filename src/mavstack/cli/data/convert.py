"""`mav data convert`: logs in the formats of other programs, many at a time on all cores."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mavstack.cli.common.errors import UsageError, failure_text
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.data.opening import add_log_options, add_selection_options, open_file
from mavstack.errors import MavstackError
from mavstack.logs.export import ExportOptions, export_log, exporter, exporter_names

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator

    from mavstack.cli.common.actions import Actions


class Job(NamedTuple):
    """The conversion of one file."""

    source: str
    target: str


class Outcome(NamedTuple):
    """The result of a job: what was written as values for JSON, and the problem if it failed."""

    job: Job
    written: dict[str, Any]
    skipped: str
    problem: str = ""


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    parser = actions.add("convert", "write logs in the formats of other programs", convert)
    add_log_options(parser, several=True)
    parser.add_argument(
        "--to", required=True, choices=exporter_names(), help="format to write", metavar="FORMAT"
    )
    parser.add_argument(
        "-o", "--output", metavar="PATH", help="file or folder to write (default: beside the log)"
    )
    parser.add_argument("--only", metavar="NAME,…", help="only these tables")
    parser.add_argument(
        "--scaled", action="store_true", help="values in their units, with NaN for unknown ones"
    )
    parser.add_argument("--enums", action="store_true", help="names of enum values instead of numbers")
    parser.add_argument(
        "--jobs", type=_jobs, default=0, metavar="N", help="processes (default: one per processor)"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object per log")
    add_selection_options(parser)


def _jobs(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text!r} is not a number of processes")
    return int(text)


def convert(arguments: Namespace) -> int:
    """Run `mav data convert`; a log that fails does not stop the others."""
    jobs = [Job(source, str(target)) for source, target in _targets(arguments)]
    failed = False
    for outcome in _outcomes(jobs, arguments):
        failed |= bool(outcome.problem) or (bool(outcome.skipped) and arguments.strict)
        _print(outcome, arguments)
    return 1 if failed else 0


def _targets(arguments: Namespace) -> Iterator[tuple[str, Path]]:
    """Yield the path to write for each log."""
    chosen = exporter(arguments.to)
    files = [Path(name) for name in arguments.files]
    output = None if arguments.output is None else Path(arguments.output)
    if output is not None and len(files) > 1 and not chosen.makes_folder and output.is_file():
        raise UsageError(f"{output} is a file; several logs need a folder")
    for file in files:
        if chosen.name == "parquet":
            yield str(file), output or file.parent / "dataset"
        elif chosen.makes_folder:
            own = file.parent / f"{file.stem}-{chosen.name}" if output is None else output
            yield str(file), own / file.stem if output is not None and len(files) > 1 else own
        elif output is None or output.is_dir() or len(files) > 1:
            yield str(file), (output or file.parent) / f"{file.stem}{chosen.suffix}"
        else:
            yield str(file), output


def _outcomes(jobs: list[Job], arguments: Namespace) -> Iterator[Outcome]:
    if len(jobs) == 1:
        with TransferProgress(f"converting {jobs[0].source}") as progress:
            yield _convert(jobs[0], arguments, progress)
        return
    workers = min(arguments.jobs or os.cpu_count() or 1, len(jobs))
    # A forked process would inherit the threads of pyarrow in an undefined state.
    with (
        TransferProgress(f"converting {len(jobs)} logs", in_bytes=False) as progress,
        ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool,
    ):
        running = [pool.submit(_convert, job, arguments) for job in jobs]
        try:
            for done, future in enumerate(as_completed(running), 1):
                progress(done, len(jobs))
                yield future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _convert(job: Job, arguments: Namespace, progress: Any = None) -> Outcome:  # noqa: ANN401 (a callback)
    """Convert one log."""
    options = ExportOptions(scaled=arguments.scaled, enums=arguments.enums)
    names = [name.strip() for name in arguments.only.split(",")] if arguments.only else ()
    try:
        with open_file(job.source, arguments) as log:
            summary = export_log(
                log, arguments.to, job.target, names=names, options=options, progress=progress
            )
    except (MavstackError, OSError) as error:
        if progress is not None:
            raise
        return Outcome(job, {}, "", failure_text(error))
    damage = summary.skipped
    return Outcome(job, summary.to_dict(), damage.describe() if damage else "")


def _print(outcome: Outcome, arguments: Namespace) -> None:
    source = outcome.job.source
    if outcome.problem:
        echo(f"mav data: {outcome.problem}", error=True)
    if arguments.json:
        echo_json(
            {"file": source, "output": outcome.job.target, "problem": outcome.problem, **outcome.written}
        )
        return
    if outcome.skipped:
        echo(f"mav data: {source}: skipped {outcome.skipped}", error=True)
    if not outcome.problem:
        rows, files = outcome.written["rows"], outcome.written["files"]
        where = files[0] if len(files) == 1 else f"{outcome.job.target} ({len(files)} files)"
        echo(f"{source}: {sum(rows.values()):,} rows of {len(rows)} messages -> {where}")
