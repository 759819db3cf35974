"""Jinja2 templates of the languages.

Each language has its templates in a folder `templates` beside its module. A variable that does not exist is
an error, and the line of a block tag leaves no line.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from mavstack.codegen.language import GeneratedFile
from mavstack.dialects.names import class_name
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jinja2 import Environment


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
        self._environment = _environment(package)
        self._environment.filters.update(
            {"pascal": class_name, "camel": camel_case, "line": one_line, **(filters or {})}
        )
        self._environment.globals.update(values)

    def file(self, path: str, template: str, /, **values: object) -> GeneratedFile:
        """Render a template as a file.

        Args:
            path: Path of the file below the output folder.
            template: Name of the template.
            values: Values that the template sees.

        Returns:
            The file.
        """
        return GeneratedFile(path, self._environment.get_template(template).render(values))


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
    first, *rest = re.split("_+", name.strip("_"))
    return first[:1].lower() + first[1:] + "".join(word[:1].upper() + word[1:] for word in rest)


def one_line(text: str) -> str:
    """Return a text for a comment of one line: without line ends and without the ends of comments."""
    return " ".join(text.split()).replace("*/", "* /").replace("]]", "] ]")
