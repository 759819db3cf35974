"""Fuzz target of the XML loader: a file with any content is a dialect or raises one DialectError.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys
import tempfile
from pathlib import Path

import atheris

# The modules of the reader are imported lazily; they are listed here to be instrumented.
with atheris.instrument_imports(include=["mavstack.dialects"]):
    from mavstack.dialects import Dialect
    from mavstack.errors import DialectError

FRAGMENTS = [
    b"<mavlink>",
    b"</mavlink>",
    b"<messages>",
    b"</messages>",
    b"<enums>",
    b"</enums>",
    b'<message id="1" name="A">',
    b'<message id="16777216" name="B">',
    b"</message>",
    b'<field type="uint8_t[255]" name="x">f</field>',
    b'<field type="float" name="class" units="m" enum="E" invalid="NaN">f</field>',
    b'<field type="char[0]" name="1x"/>',
    b"<extensions/>",
    b'<enum name="E" bitmask="true">',
    b'<entry name="E_A" value="0x1"/>',
    b'<entry name="E_B" value="2**63"/>',
    b'<entry name="E_1" value="-1"><param index="1" label="a" minValue="x"/></entry>',
    b"</enum>",
    b"<include>fuzz.xml</include>",
    b"<include>../../etc/passwd</include>",
    b'<!DOCTYPE a [<!ENTITY b "c">]>',
    b"&b;",
    b"<version>3</version><dialect>x</dialect>",
    b'<deprecated since="2020-01" replaced_by="A">t</deprecated>',
    b"<wip/>",
]
FOLDER = Path(tempfile.mkdtemp())
# A complete message with an enum, as fragments for the initial corpus.
SEED = bytes([0xFF, 0, 4, 13, 14, 15, 17, 5, 2, 6, 12, 8, 3, 1])


def compose(data: bytes) -> bytes:
    """Interpret each byte as a fragment or as itself, to generate both structure and noise."""
    return b"".join(FRAGMENTS[byte % 32] if byte % 32 < len(FRAGMENTS) else bytes([byte]) for byte in data)


def load(data: bytes) -> None:
    """Load one composed file, and use all its messages."""
    path = FOLDER / "fuzz.xml"
    path.write_bytes(data[1:] if data[:1] < b"\x40" else compose(data[1:]))
    try:
        dialect = Dialect.from_xml(path)
    except DialectError as error:
        if error.path is None:
            raise RuntimeError("the error has no path") from error
        return
    for message_class in dialect:
        message = message_class()
        assert message_class.from_payload(message.to_payload()) == message
        repr(message)


if __name__ == "__main__":
    corpus = Path(tempfile.mkdtemp())
    (corpus / "seed").write_bytes(SEED)
    atheris.Setup([*sys.argv, str(corpus)], load)
    atheris.Fuzz()
