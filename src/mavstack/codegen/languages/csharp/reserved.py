"""Names that generated C# cannot use."""

from __future__ import annotations

from typing import Final

_KEYWORDS: Final = """
abstract as base bool break byte case catch char checked class const continue decimal default delegate do
double else enum event explicit extern false finally fixed float for foreach goto if implicit in int
interface internal is lock long namespace new null object operator out override params private protected
public readonly ref return sbyte sealed short sizeof stackalloc static string struct switch this throw
true try typeof uint ulong unchecked unsafe ushort using virtual void volatile while
"""
CSHARP_WORDS: Final = frozenset(_KEYWORDS.split())

#: The files of the runtime, each with a template.
RUNTIME: Final = (
    "Crc",
    "Dialect",
    "Message",
    "MessageInfo",
    "Packet",
    "PacketEncoder",
    "PacketReader",
    "Parser",
    "Signing",
    "Wire",
)
#: The classes of the runtime, and those of .NET that the generated code uses by their short names.
CLASSES: Final = frozenset(
    {
        *RUNTIME,
        *("ArgumentException", "ArgumentOutOfRangeException", "Array", "BitConverter", "Buffer", "Convert"),
        *("Counters", "DateTime", "FieldInfo", "FieldType", "Flags", "FlagsAttribute", "Func", "Math"),
        *("Obsolete", "ObsoleteAttribute", "Predicate", "Stream", "System", "Task", "Type"),
    }
)
#: The members of messages, and the classes that the code of messages uses.
MEMBERS: Final = frozenset(
    {
        *(
            "ArgumentOutOfRangeException",
            "Dialect",
            "FieldInfo",
            "FieldType",
            "Message",
            "MessageInfo",
            "Wire",
        ),
        *("Decode", "Definition", "Encode", "Equals", "Finalize", "GetHashCode", "GetType", "GetValue"),
        *("Info", "MemberwiseClone", "ReferenceEquals", "ToPayload", "ToString"),
    }
)
