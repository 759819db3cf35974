"""Names that generated Go cannot use."""

from __future__ import annotations

from typing import Final

_KEYWORDS: Final = """
break case chan const continue default defer else fallthrough for func go goto if import interface map package
range return select struct switch type var
"""
GO_WORDS: Final = frozenset(_KEYWORDS.split())

_RUNTIME: Final = """
Counters Dialect DialectVersion Encoder Equal FieldInfo FieldType Info MaxPayloadLength Message MessageInfo
Messages NewReader NewSigner NewWriter Now Packet Parser Reader Signer TypeChar TypeDouble TypeFloat TypeInt16
TypeInt32 TypeInt64 TypeInt8 TypeUint16 TypeUint32 TypeUint64 TypeUint8 Writer
"""
#: The exported names of the runtime.
RUNTIME_NAMES: Final = frozenset(_RUNTIME.split())
#: The methods of messages.
METHODS: Final = frozenset({"FieldValue", "MessageInfo", "String"})
#: The files of the runtime, each with a template.
RUNTIME: Final = ("crc", "dialect", "doc", "encoder", "message", "parser", "signer", "stream")
