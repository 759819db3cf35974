"""Names that generated Java cannot use."""

from __future__ import annotations

from typing import Final

_WORDS: Final = """
_ abstract assert boolean break byte case catch char class const continue default do double else enum extends
false final finally float for goto if implements import instanceof int interface long native new null package
private protected public return short static strictfp super switch synchronized this throw throws transient
true try var void volatile while
"""
#: Keywords and literals.
JAVA_WORDS: Final = frozenset(_WORDS.split())

#: The classes of the runtime, each with a template.
RUNTIME: Final = (
    "Counters",
    "Crc",
    "Dialect",
    "FieldInfo",
    "FieldType",
    "Message",
    "MessageInfo",
    "Packet",
    "PacketEncoder",
    "PacketReader",
    "Parser",
    "Signing",
    "Wire",
)

#: Classes of Java that the generated code uses by their short names.
OTHER_CLASSES: Final = frozenset(
    {"Deprecated", "EnumSet", "IndexOutOfBoundsException", "Object", "Override", "String"}
)
