"""TypeScript: an ES module library with lazy field getters, for Node and browsers."""

from mavstack.codegen.languages.typescript.render import LANGUAGE

__all__ = ["LANGUAGE"]
