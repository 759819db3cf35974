"""Translations of metadata files to the language of a user (translation.schema.json).

    general file ──► summary (`translationUri`) ──► one file per locale (Qt's TS) ──► the translated metadata

The summary names the file of each locale: `{"de_DE": {"url": "mftp://…"}}`. A TS file has a context for each
text, whose name is the place of the text in the metadata: `/parameters/RTL_ALT/shortDesc`, or for texts that
occur often `$globals/group/Battery`. Which texts of a metadata file can be translated is stated in the file
itself, under `translation`; list entries are named by the attribute `key`, or else by their index. Sources:
MAVLink, component_metadata/translation.schema.json; QGroundControl, ComponentInformationTranslation.
"""

from __future__ import annotations

import html
import json
import re
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects.xml_reader import read_tree
from mavstack.errors import DialectError, MetadataError
from mavstack.services.component_metadata.contents import unpack_content
from mavstack.services.component_metadata.json_document import parse_json

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

#: The rules of a file of parameters (parameter.translation.json).
PARAMETER_RULES: Final[Mapping[str, Any]] = {
    "items": {
        "parameters": {
            "list": {
                "key": "name",
                "translate": ["shortDesc", "longDesc"],
                "translate-global": ["category", "group"],
                "items": {
                    "bitmask": {"list": {"key": "index", "translate": ["description"]}},
                    "values": {"list": {"key": "value", "translate": ["description"]}},
                },
            }
        }
    }
}
_GLOBALS: Final = "$globals"
_REFERENCE: Final = "#/$defs/"
#: Maximum depth of rules; references may be recursive.
_MAX_DEPTH: Final = 32
#: Maximum number of values to which rules are applied: rules may reach the same value in many ways.
_MAX_STEPS: Final = 300_000
#: The document type of all TS files; any other one is refused by the XML reader.
_DOCTYPE: Final = re.compile(rb"<!DOCTYPE\s+TS\s*>")


def find_locale(summary: bytes, locale: str) -> str | None:
    """Return the URI of the TS file of a locale.

    Args:
        summary: The summary file; it may be compressed.
        locale: The locale, such as "de_DE", or a language, such as "de".

    Returns:
        The URI, for want of the locale that of another one with its language; None if there is none.

    Raises:
        MetadataError: The file is not a JSON object.
    """
    entries = parse_json(unpack_content(summary))
    wanted = locale.replace("-", "_").partition(".")[0]
    language = wanted.partition("_")[0]
    names = [name for name in sorted(entries) if name == language or name.startswith(f"{language}_")]
    for name in sorted(names, key=lambda name: name != wanted):
        entry = entries[name]
        if isinstance(entry, dict) and isinstance(uri := entry.get("url"), str) and uri:
            return uri
    return None


def parse_translations(data: bytes) -> dict[str, str]:
    """Return the texts of a TS file, by their places in the metadata.

    Args:
        data: The file; it may be compressed.

    Returns:
        The texts; those without a translation yet are left out.

    Raises:
        MetadataError: The file is not a TS file.
    """
    try:
        root = read_tree(_DOCTYPE.sub(b"", unpack_content(data), count=1), "")
    except DialectError as error:
        raise MetadataError(error.problem, None, error.line) from None
    if root.tag != "TS":
        raise MetadataError(f"<{root.tag[:40]}> is not the root of a TS file")
    found = {}
    for context in root.named("context"):
        name = context.first("name")
        texts = [text for message in context.named("message") if (text := message.first("translation"))]
        if name is not None and texts and texts[-1].text:
            found[name.text] = texts[-1].text
    return found


def translate_content(content: bytes, translations: Mapping[str, str]) -> bytes:
    """Return a metadata file with its texts translated, as far as there are translations.

    Args:
        content: The metadata file; it may be compressed.
        translations: The texts by their places.

    Returns:
        The uncompressed file; the file as it is if it does not state what can be translated.

    Raises:
        MetadataError: The file is not a JSON object, or its rules are nested too deeply.
    """
    document = parse_json(unpack_content(content))
    rules = document.get("translation")
    if not isinstance(rules, dict):
        return content
    definitions = rules.get("$defs")
    _Translator(translations, definitions if isinstance(definitions, dict) else {}).apply(rules, document)
    return json.dumps(document, ensure_ascii=False).encode()


class _Translator:
    """Applies the rules of one file to its document, in place."""

    def __init__(self, translations: Mapping[str, str], definitions: Mapping[str, Any]) -> None:
        self._translations, self._definitions = translations, definitions
        self._steps = 0

    def apply(self, rules: Mapping[str, Any], value: object, place: str = "", depth: int = 0) -> None:
        """Translate a value by its rules; `place` is the name of the value."""
        self._steps += 1
        if depth > _MAX_DEPTH or self._steps > _MAX_STEPS:
            raise MetadataError("the rules of the translation are nested too deeply")
        entries, nested = rules.get("list"), rules.get("items")
        if isinstance(entries, dict) and isinstance(value, list):
            for name, entry in _named(value, entries.get("key")):
                self.apply(entries, entry, f"{place}/{name}", depth + 1)
        if isinstance(value, dict):
            self._translate(rules.get("translate"), value, place)
            self._translate(rules.get("translate-global"), value, None)
            if isinstance(nested, dict):
                self._apply_items(nested, value, place, depth)
        referred = self._definitions.get(str(rules.get("$ref", "")).removeprefix(_REFERENCE))
        if isinstance(referred, dict):
            self.apply(referred, value, place, depth + 1)

    def _apply_items(
        self, items: Mapping[str, Any], value: Mapping[str, Any], place: str, depth: int
    ) -> None:
        for name, rules in items.items():
            for key in list(value) if name == "*" else [name]:
                if key in value and isinstance(rules, dict):
                    self.apply(rules, value[key], f"{place}/{key}", depth + 1)

    def _translate(self, keys: object, value: dict[str, Any], place: str | None) -> None:
        """Replace the texts under some keys; without a place their translation is that of all equal texts."""
        for key in keys if isinstance(keys, list) else ():
            match value.get(key) if isinstance(key, str) else None:
                case str(text):
                    value[key] = self._text(place, key, text, "")
                case list(texts):
                    value[key] = [self._text(place, key, text, f"/{n}") for n, text in enumerate(texts)]

    def _text(self, place: str | None, key: str, text: object, suffix: str) -> object:
        if not isinstance(text, str):
            return text
        name = f"{_GLOBALS}/{key}/{text}" if place is None else f"{place}/{key}{suffix}"
        return self._translations.get(name, text)


def _named(entries: list[Any], key: object) -> Iterator[tuple[str, Any]]:
    """Yield the entries of a list with their names: the attribute `key`, or the index."""
    for number, entry in enumerate(entries):
        name = entry.get(key) if isinstance(entry, dict) and isinstance(key, str) else None
        yield str(number if name is None else name), entry


def to_ts(translations: Mapping[str, str], locale: str) -> bytes:
    """Return a TS file.

    Args:
        translations: The texts by their places.
        locale: The locale, such as "de_DE".

    Returns:
        The uncompressed file.
    """
    contexts = "".join(
        f"<context><name>{_escaped(name)}</name><message><source/><translation>{_escaped(text)}</translation>"
        "</message></context>\n"
        for name, text in translations.items()
    )
    head = '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE TS>\n'
    return f'{head}<TS version="2.1" language="{locale}">\n{contexts}</TS>\n'.encode()


def _escaped(text: str) -> str:
    # `xml.sax.saxutils` imports a client of HTTP, which each program with a vehicle would load.
    return html.escape(text, quote=False)
