"""The reserved words of C99 and C++."""

from __future__ import annotations

from typing import Final

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

C_WORDS: Final = frozenset(_C.split())
CPP_WORDS: Final = C_WORDS | frozenset(_CPP.split())


def identifier(name: str) -> str:
    """Return a name that is neither a word of C nor of C++: headers of C are included by programs in C++."""
    return f"{name}_" if name in CPP_WORDS else name
