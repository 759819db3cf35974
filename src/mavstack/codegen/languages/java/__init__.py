"""Java 11 and later: a class for each message, an enum for each enum, no dependencies."""

from mavstack.codegen.languages.java.library_files import LANGUAGE

__all__ = ["LANGUAGE"]
