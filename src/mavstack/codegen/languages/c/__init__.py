"""C99: headers that are compatible with those of the official C library, and their runtime."""

from mavstack.codegen.languages.c.render import LANGUAGE

__all__ = ["LANGUAGE"]
