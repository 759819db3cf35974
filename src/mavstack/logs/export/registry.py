"""The registry of export formats.

Each built-in format is a module that is imported on first use, because most need a library. Other packages
add formats by entry points of the group `mavstack.log_exporters`: the entry point has the name of the format
and loads a `LogExporter`.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.plugins import Registry

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from mavstack.logs.export.writer import ExportOptions, ExportWriter
    from mavstack.logs.log import Log

ENTRY_POINTS: Final = "mavstack.log_exporters"


@dataclass(frozen=True)
class LogExporter:
    """A format of exports.

    Attributes:
        name: Name of the format, such as "parquet".
        description: One line for users.
        suffix: Suffix of its files, with the dot.
        makes_folder: True if an export is a folder with files for each message.
        open: Makes the writer of a log; raises `MissingExtraError` if a library is missing.
    """

    name: str
    description: str
    suffix: str
    makes_folder: bool
    open: Callable[[Log, Path, ExportOptions], ExportWriter]


#: The module (below `mavstack.logs.export`) and the object of each built-in format.
EXPORTERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "parquet": "parquet:PARQUET",
        "csv": "csv_files:CSV",
        "arrow": "arrow_files:ARROW",
        "mcap": "mcap_file:MCAP",
        "mat": "mat_file:MAT",
        "tlog": "tlog_file:TLOG",
        "kml": "track_files:KML",
        "gpx": "track_files:GPX",
        "geojson": "track_files:GEOJSON",
    }
)


_REGISTRY: Final[Registry[LogExporter]] = Registry(
    "format", ENTRY_POINTS, {name: f"mavstack.logs.export.{place}" for name, place in EXPORTERS.items()}
)


def exporter_names() -> tuple[str, ...]:
    """Return the names of all formats, those of other packages included."""
    return _REGISTRY.names()


def exporter(name: str) -> LogExporter:
    """Return the format of a name.

    Args:
        name: The name, such as "parquet".

    Returns:
        The format.

    Raises:
        InvalidArgumentError: There is no such format.
    """
    return _REGISTRY.get(name)
