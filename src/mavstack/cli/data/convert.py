"""`mav data convert`: logs in the formats of other programs, many at a time on all cores."""

from __future__ import annotations

from argparse import ArgumentTypeError
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.data.conversion import ROS2, ConvertedLogs, Job, run_jobs
from mavstack.cli.data.opening import add_log_options, add_raw_text, add_selection_options
from mavstack.cli.data.remote import expand, is_remote
from mavstack.logs.export import exporter, exporter_names

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator

    from mavstack.cli.common.actions import Actions
    from mavstack.cli.data.conversion import Outcome
    from mavstack.logs.export import LogExporter


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    parser = actions.add("convert", "write logs in the formats of other programs", convert)
    add_log_options(parser, several=True)
    parser.add_argument(
        "--to", required=True, choices=exporter_names(), help="format to write", metavar="FORMAT"
    )
    parser.add_argument(
        "--profile", choices=(ROS2,), help="with mcap: the topics of ROS 2, as the bridge publishes them"
    )
    parser.add_argument(
        "-o", "--output", metavar="PATH", help="file or folder to write (default: beside the log)"
    )
    parser.add_argument("--only", metavar="NAME,…", help="only these tables")
    parser.add_argument(
        "--scaled", action="store_true", help="values in their units, with NaN for unknown ones"
    )
    parser.add_argument("--enums", action="store_true", help="names of enum values instead of numbers")
    add_raw_text(parser)
    parser.add_argument(
        "--jobs", type=_jobs, default=0, metavar="N", help="processes (default: one per processor)"
    )
    parser.add_argument(
        "--resume", metavar="FILE", help="skip the logs that this file lists, and add those that are done"
    )
    parser.add_argument(
        "--dask", metavar="ADDRESS", help="convert on a Dask cluster, such as tcp://10.0.0.1:8786"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object per log")
    add_selection_options(parser)


def _jobs(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text!r} is not a number of processes")
    return int(text)


def convert(arguments: Namespace) -> int:
    """Run `mav data convert`; a log that fails does not stop the others."""
    jobs = list(_jobs_of(arguments))
    _check_targets(jobs, arguments)
    done = None if arguments.resume is None else ConvertedLogs(arguments.resume)
    waiting = [job for job in jobs if done is None or not done.has(job)]
    if len(waiting) < len(jobs):
        before = len(jobs) - len(waiting)
        echo(f"mav data: {before} {'log was' if before == 1 else 'logs were'} converted before", error=True)
    failed = False
    for outcome in run_jobs(waiting, arguments):
        failed |= bool(outcome.problem) or (bool(outcome.skipped) and arguments.strict)
        if done is not None and not outcome.problem:
            done.add(outcome.job)
        _print(outcome, arguments)
    return 1 if failed else 0


def _jobs_of(arguments: Namespace) -> Iterator[Job]:
    """Yield the conversion of each log."""
    if arguments.profile is not None and arguments.to != "mcap":
        raise UsageError(f"--profile is for --to mcap, not for {arguments.to}")
    chosen = exporter(arguments.to)
    files = expand(arguments.files)
    output = arguments.output
    if output is None and any(map(is_remote, files)):
        raise UsageError("logs at URLs need -o PATH")
    if output is not None and len(files) > 1 and not chosen.makes_folder and Path(output).is_file():
        raise UsageError(f"{output} is a file; several logs need a folder")
    for file in files:
        yield Job(file, _target(chosen, file, output, several=len(files) > 1))


def _check_targets(jobs: list[Job], arguments: Namespace) -> None:
    """Refuse to write several logs to one path; a Parquet dataset has files of its own for each."""
    sources: dict[str, str] = {}
    for job in jobs if arguments.to != "parquet" else ():
        first = sources.setdefault(job.target, job.source)
        if first != job.source:
            raise UsageError(f"{first} and {job.source} would both be written to {job.target}")


def _target(chosen: LogExporter, file: str, output: str | None, *, several: bool) -> str:
    """Return the path to write for a log."""
    stem, folder = PurePosixPath(file.replace("\\", "/")).stem, str(Path(file).parent)
    if chosen.name == "parquet":
        return output or str(Path(folder) / "dataset")
    if chosen.makes_folder:
        if output is None:
            return str(Path(folder) / f"{stem}-{chosen.name}")
        return f"{output.rstrip('/')}/{stem}" if several else output
    if output is None or several or (not is_remote(output) and Path(output).is_dir()):
        return f"{(output or folder).rstrip('/')}/{stem}{chosen.suffix}"
    return output


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
        files = outcome.written["files"]
        where = files[0] if len(files) == 1 else f"{outcome.job.target} ({len(files)} files)"
        echo(f"{source}: {outcome.written['description']} -> {where}")
