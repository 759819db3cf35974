"""`mav data decode`: the values of frames in a file of bytes, by a decoder of the station's dashboards."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final, cast

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_json

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Iterator
    from io import BufferedReader

    from mavstack.cli.common.actions import Actions
    from mavstack.server.rows.template import Row

_CHUNK: Final = 1 << 16


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    parser = actions.add("decode", "values of frames in bytes, by a decoder of dashboards", decode)
    parser.add_argument(
        "decoder", type=Path, metavar="DECODER", help="file of a decoder, dashboard or project"
    )
    parser.add_argument("bytes", nargs="?", metavar="FILE", help="file of bytes; - reads the standard input")
    parser.add_argument("--hex", metavar="DIGITS", help="bytes in hexadecimal digits in place of a file")
    parser.add_argument("--name", default="", help="name of the decoder, if the file has several")
    parser.add_argument("--json", action="store_true", help="print one JSON object per row")


def decode(arguments: Namespace) -> int:
    """Run `mav data decode`; without bytes the decoder is checked alone."""
    from mavstack.server.rows.decoder_file import read_decoder_file
    from mavstack.server.rows.frame_decoder import FrameReader

    decoder = read_decoder_file(arguments.decoder, arguments.name)
    if arguments.hex is not None and arguments.bytes is not None:
        raise UsageError("either a file of bytes or --hex is needed, not both")
    if arguments.hex is None and arguments.bytes is None:
        names = ", ".join(each.name for each in decoder.messages) or "none: its frames are for scripts"
        echo(f"{decoder.name} is valid; messages: {names}")
        return 0
    reader, count = FrameReader(decoder), 0
    for chunk in _chunks(arguments, whole=decoder.framing.kind == "datagram"):
        for row in reader.feed(chunk):
            count += 1
            _print(row, as_json=arguments.json)
    if reader.refused:
        raise CommandError(f"{count} rows; {reader.refused} frames were damaged, too long or fit no message")
    return 0


def _print(row: Row, *, as_json: bool) -> None:
    data = {} if row.data is None else {"data": row.data.hex()}
    if as_json:
        echo_json({"message": row.message, "fields": dict(row.fields), **data})
        return
    values = " ".join(f"{name}={value}" for name, value in {**row.fields, **data}.items())
    echo(f"{row.message} {values}")


def _open(name: str) -> BufferedReader:
    return cast("BufferedReader", sys.stdin.buffer) if name == "-" else Path(name).open("rb")


def _chunks(arguments: Namespace, *, whole: bool) -> Iterator[bytes]:
    """Yield the bytes as they arrive; all bytes are one datagram if `whole`."""
    from mavstack.server.rows.framing import MAX_DATAGRAM

    if arguments.hex is not None:
        try:
            yield bytes.fromhex(arguments.hex)
        except ValueError:
            raise UsageError(
                f"--hex must be hexadecimal digits such as aa55, got {arguments.hex!r:.40}"
            ) from None
        return
    try:
        with _open(arguments.bytes) as file:
            if whole:
                yield file.read(MAX_DATAGRAM + 1)
                return
            while chunk := file.read1(_CHUNK):  # not `read`, which waits until a pipe fills a chunk
                yield chunk
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CommandError(f"reading {arguments.bytes} failed: {reason}") from None
