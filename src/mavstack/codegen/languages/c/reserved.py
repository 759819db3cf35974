"""The names that generated C and C++ cannot use, and the form of strings."""

from __future__ import annotations

import re
from typing import Final

from mavstack.codegen.templates import string_literal

_C = """
auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
_Bool _Complex _Imaginary bool true false
"""
_CPP = """
alignas alignof and and_eq asm bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield
compl concept const_cast consteval constexpr constinit decltype delete dynamic_cast explicit export friend
mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public reinterpret_cast
requires static_assert static_cast template this thread_local throw try typeid typename using virtual wchar_t
xor xor_eq
"""

#: Types and macros of the standard headers that the library includes.
_STANDARD = """
EOF FALSE INFINITY MAX MIN NAN NO_DATA NULL TRUE int16_t int32_t int64_t int8_t linux memcmp memcpy memset
offsetof ptrdiff_t size_t std strlen uint16_t uint32_t uint64_t uint8_t unix
"""
#: Other parameters, and variables, of the functions that have a parameter for each field.
_PARAMETERS: Final = frozenset({"_buf", "_status", "chan", "component_id", "msg", "msgbuf", "system_id"})
#: Names of messages whose struct would have the name of a type of the runtime.
_RUNTIME_TYPES: Final = frozenset(
    {
        *("accept_unsigned", "channel", "counters", "field_info", "framing", "message", "message_info"),
        *("message_type", "msg_entry", "param_union", "param_union_double", "parse_state", "parser"),
        *("signing", "signing_status", "signing_streams", "status", "system"),
    }
)

_NOT_WORD: Final = re.compile(r"\W", re.ASCII)
_CPP_WORDS: Final = frozenset({*_C.split(), *_CPP.split()})
RESERVED: Final = _CPP_WORDS | frozenset(_STANDARD.split())


def identifier(name: str) -> str:
    """Return a name that neither C nor C++ has: headers of C are included by programs in C++."""
    return f"{name}_" if name in RESERVED else name


def parameter(name: str) -> str:
    """Return the name of the parameter for a field or a message."""
    return f"{name}_" if name in _PARAMETERS else identifier(name)


def struct_name(message: str) -> str:
    """Return the middle of the names of a message's struct and functions: `attitude` of `ATTITUDE`."""
    lower = message.lower()
    return f"{lower}_" if lower in _RUNTIME_TYPES else lower


def namespace(file: str) -> str:
    """Return the namespace of a definition file, which is also the name of its macros in lower case."""
    name = identifier(_NOT_WORD.sub("_", file))
    return f"dialect_{name}" if name[:1].isdigit() else name


def quoted(text: str) -> str:
    """Return a string of C and C++, without trigraphs."""
    literal = string_literal(text)
    return literal.replace("?", "\\?") if "??" in literal else literal
