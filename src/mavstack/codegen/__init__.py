"""Code generators: libraries in other languages from the definitions of a dialect.

A `Library` is the model of what is generated: the selected messages and enums, by definition file and merged.
A `Language` renders it as files, by Jinja2 templates in a folder of its own below `codegen.languages`.
`generate` joins both; `write_files` and `outdated_files` compare the result with a folder. Equal definitions
and options give equal bytes.
"""

from mavstack.codegen.language import ENTRY_POINTS, GeneratedFile, Language, language, language_names
from mavstack.codegen.library import DialectFile, Library, make_library
from mavstack.codegen.output import generate, outdated_files, write_files

__all__ = [
    "ENTRY_POINTS",
    "DialectFile",
    "GeneratedFile",
    "Language",
    "Library",
    "generate",
    "language",
    "language_names",
    "make_library",
    "outdated_files",
    "write_files",
]
