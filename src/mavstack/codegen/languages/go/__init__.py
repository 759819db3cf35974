"""Go 1.21 and later: a struct for each message, a type for each enum, no dependencies."""

from mavstack.codegen.languages.go.library_files import LANGUAGE

__all__ = ["LANGUAGE"]
