"""Jinja2 templates of the languages.

Each language has its templates in a folder `templates` beside its module. A variable that does not exist is
an error, and the line of a block tag leaves no line. A template that has only variables needs no Jinja2: to
import and to compile would take longer than to generate a library.
"""

# ruff: noqa: PTH118, PTH120, PTH123
# (importing pathlib or importlib.resources takes longer than to generate a small library)
from __future__ import annotations

import os
import re
from functools import cached_property, lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.codegen.language import GeneratedFile
from mavstack.dialects.names import class_name
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jinja2 import Environment

#: The end of a line that C joins with the next line.
_CONTINUED: Final = re.compile(r"(?:\\|\?\?/|\s)+$")
_VARIABLE: Final = re.compile(r"\{\{ ([a-z_]+)((?:\.[a-z_]+)*) \}\}")


class Templates:
    """The templates of one language.

    Args:
        package: Package of the language, such as `mavstack.codegen.languages.c`.
        filters: Filters of the language, in addition to those here.
        values: Values that all templates see.
    """

    def __init__(
        self, package: str, /, *, filters: Mapping[str, Callable[..., Any]] | None = None, **values: object
    ) -> None:
        self._package = package
        self._filters = {"pascal": class_name, "camel": camel_case, "line": one_line, **(filters or {})}
        self._values = values
        self._flat: dict[str, FlatTemplate | None] = {}

    def file(self, path: str, template: str, /, **values: object) -> GeneratedFile:
        """Render a template as a file.

        Args:
            path: Path of the file below the output folder.
            template: Name of the template.
            values: Values that the template sees.

        Returns:
            The file.
        """
        return GeneratedFile(path, self.text(template, **values))

    def text(self, template: str, /, **values: object) -> str:
        """Render a template.

        Args:
            template: Name of the template.
            values: Values that the template sees.

        Returns:
            The text.
        """
        flat = self._find_flat(template)
        if flat is not None:
            return flat.render({**self._values, **values})
        return self._environment.get_template(template).render(values)

    def _find_flat(self, name: str) -> FlatTemplate | None:
        if name not in self._flat:
            with open(os.path.join(self._folder, name), encoding="utf-8") as file:
                source = file.read()
            self._flat[name] = FlatTemplate(source) if FlatTemplate.fits(source) else None
        return self._flat[name]

    @cached_property
    def _folder(self) -> str:
        return os.path.join(os.path.dirname(str(import_module(self._package).__file__)), "templates")

    @cached_property
    def _environment(self) -> Environment:
        environment = _environment(self._package)
        environment.filters.update(self._filters)
        environment.globals.update(self._values)
        return environment


class FlatTemplate:
    """A template that has only variables and their attributes.

    Args:
        source: The text of the template.
    """

    def __init__(self, source: str) -> None:
        words = _VARIABLE.split(source)
        self._texts = words[::3]
        attributes = zip(words[1::3], words[2::3], strict=True)
        self._variables = [(name, path[1:].split(".") if path else []) for name, path in attributes]

    @staticmethod
    def fits(source: str) -> bool:
        """Return whether a template has only variables."""
        return not any(mark in _VARIABLE.sub("", source) for mark in ("{{", "{%", "{#"))

    def render(self, values: Mapping[str, Any]) -> str:
        """Return the text; raises KeyError or AttributeError if a variable does not exist."""
        parts = [self._texts[0]]
        for (name, path), text in zip(self._variables, self._texts[1:], strict=True):
            value = values[name]
            for attribute in path:
                value = value[attribute] if isinstance(value, dict) else getattr(value, attribute)
            parts += (str(value), text)
        return "".join(parts)


def _environment(package: str) -> Environment:
    try:
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError:
        raise MissingExtraError("mav gen", "gen") from None
    return Environment(
        loader=PackageLoader(package),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 (the output is source code, not HTML)
        auto_reload=False,
    )


def camel_case(name: str) -> str:
    """Return an identifier such as `timeBootMs` for `time_boot_ms`."""
    pascal = "".join([word[:1].upper() + word[1:] for word in name.split("_")])
    return pascal[:1].lower() + pascal[1:]


def plain_line(text: str) -> str:
    """Return a text on one line without invisible characters, such as those that turn its direction."""
    line = " ".join(text.split())
    return line if line.isprintable() else "".join(filter(str.isprintable, line))


def one_line(text: str) -> str:
    """Return a text for a comment of one line, in any language.

    It has no mark that begins or ends a comment, and does not end with a backslash (in C also the trigraph
    `??/`), which would continue the comment in the next line.
    """
    if not text:
        return ""
    line = plain_line(text)
    if "*/" in line or "/*" in line or line.endswith(("\\", "/")):
        line = line.replace("*/", "* /").replace("/*", "/ *")
        line = _CONTINUED.sub("", line)
    return line


@lru_cache(maxsize=1024)  # most texts are units, which repeat
def string_literal(text: str) -> str:
    """Return a string of one line in double quotes, with the escapes that all languages here share."""
    escaped = plain_line(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
