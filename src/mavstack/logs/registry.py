"""The registry of log formats, recognised by content, never by the name of a file.

Each built-in format is an object of `LogFormat` in a module of `formats`, which imports its reader only when
a file of the format is opened. Other packages add formats by entry points of the
group `mavstack.log_formats`: the entry point has the name of the format and loads a `LogFormat`.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from importlib.metadata import EntryPoints

    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

ENTRY_POINTS: Final = "mavstack.log_formats"
#: Bytes at the beginning of a file by which its format is recognised.
MAX_HEAD: Final = 1 << 18


@dataclass(frozen=True)
class LogFormat:
    """A format of log files.

    Attributes:
        name: Name of the format, such as "ulog".
        description: One line for users, such as "PX4 ULog".
        matches: Returns whether a file that begins with these bytes (up to `MAX_HEAD`) has the signature of
            the format.
        open: Opens the file; raises `LogError` if it cannot be read at all.
    """

    name: str
    description: str
    matches: Callable[[bytes], bool]
    open: Callable[[LogBytes, OpenOptions], Log]


#: Module and object of each built-in format below `mavstack.logs.formats`.
FORMATS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "dataflash": "dataflash:DATAFLASH",
        "dataflash-text": "dataflash:DATAFLASH_TEXT",
        "tlog": "packets:TLOG",
        "raw": "packets:RAW",
        "pcap": "pcap:PCAP",
        "ulog": "ulog:ULOG",
        "blackbox": "blackbox:BLACKBOX",
    }
)


def format_names() -> tuple[str, ...]:
    """Return the names of all formats, those of other packages included."""
    return (*FORMATS, *sorted(plugins().names - FORMATS.keys()))


def log_format(name: str) -> LogFormat:
    """Return the format of a name.

    Args:
        name: The name, such as "tlog".

    Returns:
        The format.

    Raises:
        InvalidArgumentError: There is no such format.
    """
    if name in FORMATS:
        module, attribute = FORMATS[name].split(":")
        builtin: LogFormat = getattr(import_module(f"mavstack.logs.formats.{module}"), attribute)
        return builtin
    found = plugins()
    if name not in found.names:
        raise InvalidArgumentError(f"format must be one of {', '.join(format_names())}, got {name!r}")
    plugin: LogFormat = found[name].load()
    return plugin


def recognise(head: bytes) -> LogFormat | None:
    """Return the built-in format whose signature a file has, or None.

    Args:
        head: The first bytes of the file, up to `MAX_HEAD`.
    """
    return _first_match(map(log_format, FORMATS), head)


def recognise_plugin(head: bytes) -> LogFormat | None:
    """Return the format of another package whose signature a file has, or None.

    Args:
        head: The first bytes of the file, up to `MAX_HEAD`.
    """
    return _first_match((log_format(name) for name in sorted(plugins().names)), head)


def plugins() -> EntryPoints:
    """Return the entry points of other packages, by format."""
    from importlib.metadata import entry_points

    return entry_points(group=ENTRY_POINTS)


def _first_match(formats: Iterable[LogFormat], head: bytes) -> LogFormat | None:
    return next((candidate for candidate in formats if candidate.matches(head)), None)
