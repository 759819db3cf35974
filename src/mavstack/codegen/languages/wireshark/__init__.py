"""A dissector for Wireshark, in Lua."""

from mavstack.codegen.languages.wireshark.render import LANGUAGE

__all__ = ["LANGUAGE"]
