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

_CLASSES: Final = """
AbstractMethodError Appendable ArithmeticException ArrayStoreException AssertionError AutoCloseable Boolean
Byte CharSequence Character Class ClassLoader ClassValue Cloneable Comparable Compiler Deprecated Double
Enum Error Exception Float FunctionalInterface IndexOutOfBoundsException Integer Iterable LinkageError Long
Math Module ModuleLayer Number Object Override Package Process ProcessBuilder ProcessHandle Readable Record
Runnable Runtime RuntimeException SafeVarargs ScopedValue SecurityException SecurityManager Short
StackWalker StrictMath String StringBuffer StringBuilder StringTemplate SuppressWarnings System Thread
ThreadGroup ThreadLocal Throwable Void
"""
#: Classes of `java.lang`, whose names would become ambiguous, and other classes that the generated code uses.
OTHER_CLASSES: Final = frozenset({*_CLASSES.split(), "EnumSet"})
