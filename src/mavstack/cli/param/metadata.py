"""The metadata of parameters on the command line: where it comes from, and how it is shown."""

from __future__ import annotations

import logging
from textwrap import wrap
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.errors import RemoteCancelled, RemoteError
from mavstack.files.parameters import value_text
from mavstack.services.parameters.metadata import NO_METADATA, number_text
from mavstack.services.parameters.value import type_name

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterator

    from mavstack.services.parameters import MetadataTable, Parameter, ParameterMetadata
    from mavstack.vehicle import Vehicle

#: Seconds to download the metadata; then the parameter is set without the check against the metadata.
CHECK_TIMEOUT: Final = 30.0
_LOGGER: Final = logging.getLogger("mavstack.cli")
_INDENT: Final = "    "
_WIDTH: Final = 100


def add_metadata_option(parser: ArgumentParser) -> None:
    """Declare `--metadata` and `--locale`."""
    parser.add_argument(
        "--metadata",
        metavar="FILE",
        help="descriptions and ranges from a file of the firmware project (apm.pdef.xml, apm.pdef.json, "
        "parameters.json, parameters.xml); remembered for this firmware (default: from the vehicle)",
    )
    parser.add_argument(
        "--locale",
        metavar="NAME",
        help="translate the descriptions of the vehicle, such as de_DE, if it has a translation",
    )


async def metadata_to_show(vehicle: Vehicle, arguments: Namespace) -> MetadataTable:
    """Return the metadata of a vehicle; if there is none, say why on stderr."""
    try:
        return await _find(vehicle, arguments, None)
    except RemoteCancelled:
        raise
    except RemoteError as error:
        text = of_vehicle(vehicle, f"{error}; --metadata FILE takes descriptions from a file")
        echo(f"mav param: {text}", error=True)
        return NO_METADATA


async def metadata_for_checks(vehicle: Vehicle, arguments: Namespace) -> MetadataTable:
    """Return the metadata against which values are checked; nothing is checked if there is none."""
    if arguments.force:
        return NO_METADATA
    try:
        return await _find(vehicle, arguments, CHECK_TIMEOUT)
    except RemoteCancelled:
        raise
    except RemoteError as error:
        _LOGGER.info("values are not checked: %s", error)
        return NO_METADATA


async def _find(vehicle: Vehicle, arguments: Namespace, timeout: float | None) -> MetadataTable:  # noqa: ASYNC109
    params = vehicle.params
    if arguments.metadata is not None:
        return await params.load_metadata(arguments.metadata, remember=True)
    if params.metadata and arguments.locale is None:
        return params.metadata
    with TransferProgress("downloading descriptions") as progress:
        return await params.download_metadata(locale=arguments.locale, timeout=timeout, progress=progress)


def description_lines(parameter: Parameter, metadata: ParameterMetadata | None) -> Iterator[str]:
    """Yield the lines that describe a parameter and its value."""
    kind = type_name(int(parameter.type)).lower()
    unit = f" {metadata.unit}" if metadata is not None and metadata.unit else ""
    yield f"{parameter.name}  {value_text(parameter)}{unit}  {kind}"
    if metadata is None:
        yield f"{_INDENT}no description"
        return
    texts = metadata.short_description, metadata.long_description
    for text in dict.fromkeys(filter(None, texts)):
        yield from wrap(text, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)
    facts = ", ".join(_facts(metadata))
    if facts:
        yield _INDENT + facts
    for value, name in sorted(metadata.values.items()):
        mark = "*" if value == parameter.value else " "
        yield f"{_INDENT}{mark} {number_text(value)}: {name}"
    for bit, name in sorted(metadata.bitmask.items()):
        mark = "*" if int(parameter.value) >> bit & 1 else " "
        yield f"{_INDENT}{mark} bit {bit} ({1 << bit}): {name}"


def _facts(metadata: ParameterMetadata) -> Iterator[str]:
    if metadata.has_range:
        yield f"range {metadata.range_text}"
    if metadata.default is not None:
        yield f"default {number_text(metadata.default)}"
    if metadata.increment is not None:
        yield f"step {number_text(metadata.increment)}"
    if metadata.reboot_required:
        yield "takes effect after a reboot"
    if metadata.read_only:
        yield "read-only"


def json_metadata(metadata: ParameterMetadata | None) -> dict[str, object] | None:
    """Return metadata for JSON; None if there is none."""
    if metadata is None:
        return None
    return {
        "short_description": metadata.short_description,
        "long_description": metadata.long_description,
        "unit": metadata.unit,
        "minimum": metadata.minimum,
        "maximum": metadata.maximum,
        "default": metadata.default,
        "increment": metadata.increment,
        "values": {number_text(value): name for value, name in sorted(metadata.values.items())},
        "bitmask": {str(bit): name for bit, name in metadata.bitmask.items()},
        "reboot_required": metadata.reboot_required,
        "read_only": metadata.read_only,
    }
