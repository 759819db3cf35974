"""Names in a definition that generated libraries change, because a language reserves them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.codegen.language import language, language_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.model import DialectDefinition


def reserved_names(definition: DialectDefinition) -> Iterator[tuple[int, str]]:
    """Yield the line and text of each field whose name is a reserved word of a language.

    Args:
        definition: The content of one file.
    """
    words: dict[str, list[str]] = {}
    for name in language_names():
        for word in language(name).reserved_words:
            words.setdefault(word, []).append(name)
    for message in definition.messages:
        for field in message.fields:
            if field.name in words:
                languages = ", ".join(words[field.name])
                text = f"{message.name}.{field.name} is a reserved word in {languages}"
                yield field.line, f"{text}, whose libraries name it {field.name}_"
