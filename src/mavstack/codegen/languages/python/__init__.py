"""Python without dependencies: plain classes with types, for CPython and MicroPython."""

from mavstack.codegen.languages.python.language import LANGUAGE

__all__ = ["LANGUAGE"]
