"""The expected results, from the core, and the lines of the files."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen import make_library
from mavstack.dialects import Dialect
from mavstack.wire import Parser, Signing, encode
from tools.conformance.cases import Case, Cases

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.wire import Packet

#: The dialects that have a file each.
DIALECTS: Final = ("common", "all")
#: The lead of a packet over the receiver's clock is not part of the corpus.
_ANY_LEAD: Final = 1e9
#: Longer than any packet.
_PADDING: Final = bytes(300)


def corpus_text(name: str) -> str:
    """Return the content of the file of a dialect.

    Raises:
        ValueError: The result of an input depends on its chunks.
    """
    dialect = Dialect.load(name)
    cases = Cases(dialect.definition, make_library(dialect).version).all()
    lines = [json.dumps(line(case, dialect), separators=(",", ":")) for case in cases]
    return "".join(f"{item}\n" for item in lines)


def line(case: Case, dialect: Dialect) -> dict[str, Any]:
    """Return a case with its expected result.

    Zeros are appended where a parser would still wait for the end of an apparent packet.
    """
    whole = _result(case, dialect, [case.data])
    if whole != _result(case, dialect, [case.data], flush=True):
        case = replace(case, data=case.data + _PADDING)
        whole = _result(case, dialect, [case.data])
    if whole != _result(case, dialect, [case.data[index : index + 1] for index in range(len(case.data))]):
        raise ValueError(f"the result of {case.name} depends on its chunks")
    return {
        "name": case.name,
        "key": case.key.hex() if case.key else None,
        "now": case.now,
        "input": case.data.hex(),
        **whole,
    }


def _result(case: Case, dialect: Dialect, chunks: Iterable[bytes], *, flush: bool = False) -> dict[str, Any]:
    signing = Signing(case.key, timestamp=case.now or 0, max_ahead=_ANY_LEAD) if case.key else None
    parser = Parser(dialect, signing=signing)
    packets = [packet for chunk in chunks for packet in parser.feed(chunk)]
    packets += parser.flush() if flush else []
    known = [packet for packet in packets if packet.message is not None]
    counters = {
        "good": len(known),
        "bad_crc": parser.statistics.bad_checksum,
        "bad_signature": signing.refusals.total if signing else 0,
        "unknown": parser.statistics.unknown,
    }
    return {"packets": [_packet(packet, dialect, case.key) for packet in known], "counters": counters}


def _packet(packet: Packet, dialect: Dialect, key: bytes | None) -> dict[str, Any]:
    definition = dialect.message_definition(packet.message_id)
    data = packet.payload[: definition.length].ljust(definition.length, b"\0")
    return {
        "id": packet.message_id,
        "message": definition.name,
        "version": packet.version,
        "sequence": packet.sequence,
        "system": packet.system,
        "component": packet.component,
        "signed": packet.signed,
        "fields": {
            field.name: data[field.offset : field.offset + field.size].hex() for field in definition.fields
        },
        "packed": _packed(packet, key).hex(),
    }


def _packed(packet: Packet, key: bytes | None) -> bytes:
    """Return the message packed again; signed if the receiver has the key."""
    signing = None
    if packet.signed and key is not None:
        signing = Signing(key, packet.link_id or 0, timestamp=(packet.signature_timestamp or 1) - 1)
    return encode(
        packet.message,
        system=packet.system,
        component=packet.component,
        sequence=packet.sequence,
        version=packet.version,
        signing=signing,
    )
