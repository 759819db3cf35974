"""The log of a command: `-v` and `-vv` show it on stderr, `--log-file` writes it to a file.

The package logs through the loggers below `mavstack`. Without these options nothing is shown: commands report
failures themselves. Commands that draw on the whole terminal hold the lines for stderr back until they end.
"""

from __future__ import annotations

from argparse import SUPPRESS
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.output import echo
from mavstack.cli.common.text import printable
from mavstack.errors import MissionWarning

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterator
    from logging import Formatter, Handler, LogRecord

ROOT_LOGGER: Final = "mavstack"
#: Title of the group of logging options in help texts.
LOGGING_GROUP: Final = "logging"
_STDERR_FORMAT: Final = "%(asctime)s.%(msecs)03d %(levelname)s %(name)s: %(message)s"
_STDERR_TIME: Final = "%H:%M:%S"
_FILE_FORMAT: Final = "%(asctime)s.%(msecs)03d %(levelname)s %(name)s: %(message)s"
_FILE_TIME: Final = "%Y-%m-%dT%H:%M:%S"


def add_logging_options(parser: ArgumentParser) -> None:
    """Declare `-v` and `--log-file`; an action that has a `-v` of its own only gets `--verbose`.

    They have no defaults in the parsed arguments, so that they may stand before and after the name of an
    action.
    """
    group = parser.add_argument_group(LOGGING_GROUP)
    taken = "-v" in parser._option_string_actions  # noqa: SLF001 (argparse has no public access)
    group.add_argument(
        *(() if taken else ("-v",)),
        "--verbose",
        action="count",
        default=SUPPRESS,
        help="show the log on stderr; -vv also shows debug messages",
    )
    group.add_argument(
        "--log-file", metavar="FILE", default=SUPPRESS, help="append the log, with debug messages, to a file"
    )


@contextmanager
def logging_to_outputs(arguments: Namespace, *, quiet: bool = False) -> Iterator[None]:
    """Send the log where the arguments say while the block runs.

    Args:
        arguments: The arguments of the command.
        quiet: True if the block logs nothing; then only the options need `logging`, which is slow to import.

    Raises:
        OSError: The log file cannot be opened.
    """
    if quiet and not (hasattr(arguments, "verbose") or hasattr(arguments, "log_file")):
        yield
        return
    import logging

    logger = logging.getLogger(ROOT_LOGGER)
    handlers = _handlers(getattr(arguments, "verbose", 0), getattr(arguments, "log_file", None))
    level = logger.level
    if handlers:
        logger.setLevel(min(handler.level for handler in handlers))
    handlers.append(logging.NullHandler())  # without any handler Python prints warnings on stderr
    for handler in handlers:
        logger.addHandler(handler)
    try:
        yield
    except Exception:
        logger.getChild("cli").debug("the command failed", exc_info=True)
        raise
    finally:
        for handler in handlers:
            logger.removeHandler(handler)
            handler.close()
        logger.setLevel(level)


@contextmanager
def warnings_as_lines(name: str) -> Iterator[None]:
    """Show each `MissionWarning` as one line on stderr, after the name of the command."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("always", MissionWarning)
        show_as_python = warnings.showwarning

        def show(message: Warning | str, *where: Any) -> None:  # noqa: ANN401 (as in the warnings module)
            if isinstance(message, MissionWarning):
                echo(f"{name}: warning: {' '.join(str(message).split())}", error=True)
            else:
                show_as_python(message, *where)

        warnings.showwarning = show  # type: ignore[assignment]
        yield


@contextmanager
def stderr_log_held() -> Iterator[None]:
    """Hold back the log lines for stderr while the block runs, because a display covers the terminal."""
    import logging

    from mavstack.cli.common.stderr_handler import StderrHandler

    shown = [each for each in logging.getLogger(ROOT_LOGGER).handlers if isinstance(each, StderrHandler)]
    for handler in shown:
        handler.hold_lines()
    try:
        yield
    finally:
        for handler in shown:
            handler.print_held_lines()


def _formatter(text_format: str, time_format: str) -> Formatter:
    """Return a formatter of lines without control characters; a traceback keeps its line breaks."""
    import logging

    class PrintableFormatter(logging.Formatter):
        """Formats a record without the control characters of texts from outside."""

        def format(self, record: LogRecord) -> str:
            """Format a record."""
            return "\n".join(map(printable, super().format(record).split("\n")))

    return PrintableFormatter(text_format, time_format)


def _handlers(verbosity: int, path: str | None) -> list[Handler]:
    import logging

    from mavstack.cli.common.stderr_handler import StderrHandler

    handlers: list[Handler] = []
    if path is not None:
        file = logging.FileHandler(path, encoding="utf-8")
        file.setLevel(logging.DEBUG)
        file.setFormatter(_formatter(_FILE_FORMAT, _FILE_TIME))
        handlers.append(file)
    if verbosity:
        shown = StderrHandler()
        shown.setLevel(logging.INFO if verbosity == 1 else logging.DEBUG)
        shown.setFormatter(_formatter(_STDERR_FORMAT, _STDERR_TIME))
        handlers.append(shown)
    return handlers
