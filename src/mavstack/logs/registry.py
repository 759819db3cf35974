"""The registry of log formats, recognised by content, never by the name of a file.

Each built-in format is an object of `LogFormat` in a module of `formats`, which imports its reader only when
a file of the format is opened. Other packages add formats by entry points of the
group `mavstack.log_formats`: the entry point has the name of the format and loads a `LogFormat`.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.plugins import Registry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from importlib.metadata import EntryPoints

    from mavstack.logs.log import Log
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.logs.options import OpenOptions

ENTRY_POINTS: Final = "mavstack.log_formats"
#: Number of bytes at the beginning of a file that identify its format.
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


#: The module (below `mavstack.logs.formats`) and the object of each built-in format.
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


_REGISTRY: Final[Registry[LogFormat]] = Registry(
    "format", ENTRY_POINTS, {name: f"mavstack.logs.formats.{place}" for name, place in FORMATS.items()}
)


def log_format(name: str) -> LogFormat:
    """Return the format of a name.

    Args:
        name: The name, such as "tlog".

    Returns:
        The format.

    Raises:
        InvalidArgumentError: There is no such format.
    """
    return _REGISTRY.get(name)


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
    return _first_match((found for _, found in _REGISTRY.plugin_items()), head)


def plugins() -> EntryPoints:
    """Return the entry points of other packages, by format."""
    return _REGISTRY.plugins()


def _first_match(formats: Iterable[LogFormat], head: bytes) -> LogFormat | None:
    return next((candidate for candidate in formats if candidate.matches(head)), None)
