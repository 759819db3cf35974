"""Camera definition files: XML, plain or compressed with xz (guide: camera definition file).

The file comes from a camera, so nothing in it is trusted: document type declarations and entities are
refused, as are files, settings and options beyond the limits, and an xz stream that grows beyond them. Every
problem is a `DialectError` with the line.
"""

from __future__ import annotations

import lzma
from typing import TYPE_CHECKING, NoReturn

from mavstack.dialects import common
from mavstack.dialects.xml_reader import Element, read_tree
from mavstack.errors import DialectError
from mavstack.services.camera.definition import (
    CameraDefinition,
    CameraSetting,
    OptionRange,
    SettingOption,
    number,
)

if TYPE_CHECKING:
    from mavstack.services.camera.definition import SettingValue

MAX_FILE_BYTES = 4 * 1024 * 1024
MAX_SETTINGS = 2000
MAX_OPTIONS = 1000
#: Bytes that the decompressor may use.
MAX_MEMORY = 64 * 1024 * 1024
#: Names of extended parameters.
MAX_NAME = 16

_XZ_MAGIC = b"\xfd7zXZ\x00"
_KIND = common.MavParamExtType
_TYPES = {
    "bool": _KIND.UINT8,
    "uint8": _KIND.UINT8,
    "int8": _KIND.INT8,
    "uint16": _KIND.UINT16,
    "int16": _KIND.INT16,
    "uint32": _KIND.UINT32,
    "int32": _KIND.INT32,
    "uint64": _KIND.UINT64,
    "int64": _KIND.INT64,
    "float": _KIND.REAL32,
    "double": _KIND.REAL64,
    "custom": _KIND.CUSTOM,
    "string": _KIND.CUSTOM,
}


def read_definition(data: bytes, path: str = "camera definition") -> CameraDefinition:
    """Read a camera definition file.

    Args:
        data: The content, plain or xz.
        path: The name of the file, for errors.

    Returns:
        The definition.

    Raises:
        DialectError: The file is malformed, too large, or no camera definition; the text has the line.
    """
    text = _decompressed(data, path)
    if len(text) > MAX_FILE_BYTES:
        raise DialectError(f"larger than {MAX_FILE_BYTES} bytes", path)
    root = read_tree(text, path)
    if root.tag != "mavlinkcamera":
        raise DialectError(f"not a camera definition: the root is <{root.tag}>", path, root.line)
    return _Reader(path).definition(root)


def _decompressed(data: bytes, path: str) -> bytes:
    if not data.startswith(_XZ_MAGIC):
        return data
    decompressor = lzma.LZMADecompressor(memlimit=MAX_MEMORY)
    try:
        text = decompressor.decompress(data, MAX_FILE_BYTES + 1)
    except lzma.LZMAError as error:
        raise DialectError(f"damaged xz data: {error}", path) from None
    if len(text) <= MAX_FILE_BYTES and not decompressor.eof:
        raise DialectError("the xz data end too early", path)
    return text


class _Reader:
    """Reads the elements of one file."""

    def __init__(self, path: str) -> None:
        self._path = path

    def definition(self, root: Element) -> CameraDefinition:
        head, parameters = root.first("definition"), root.first("parameters")
        settings: dict[str, CameraSetting] = {}
        elements = list(parameters.named("parameter")) if parameters is not None else []
        elements += [] if parameters is None else list(parameters.named("param"))
        for element in sorted(elements, key=lambda each: each.line):
            setting = self._setting(element)
            if setting.name in settings:
                self._fail(f"setting {setting.name} is defined twice", element)
            settings[setting.name] = setting
            if len(settings) > MAX_SETTINGS:
                self._fail(f"more than {MAX_SETTINGS} settings", element)
        if head is None:
            return CameraDefinition(settings=settings)
        version = head.attributes.get("version", "0")
        return CameraDefinition(
            _text(head.first("model")),
            _text(head.first("vendor")),
            int(version) if version.isascii() and version.isdecimal() else 0,
            settings,
        )

    def _setting(self, element: Element) -> CameraSetting:
        get = element.attributes.get
        name, kind_name = get("name", ""), get("type", "")
        if not name or len(name.encode()) > MAX_NAME:
            self._fail(f"a setting needs a name of 1 to {MAX_NAME} bytes", element)
        if kind_name not in _TYPES:
            self._fail(f"setting {name} has the unknown type {kind_name!r}", element)
        kind = int(_TYPES[kind_name])
        return CameraSetting(
            name,
            kind,
            self._value(get("default", "" if kind == _KIND.CUSTOM else "0"), kind, element),
            _text(element.first("description")),
            tuple(self._options(element.first("options"), kind)),
            self._limit(element, "min"),
            self._limit(element, "max"),
            self._limit(element, "step"),
            get("unit", ""),
            get("control", "1") != "0",
            get("readonly", "0") in ("1", "true"),
            get("writeonly", "0") in ("1", "true"),
            self._texts(element, "updates", "update"),
            kind_name == "bool",
        )

    def _options(self, element: Element | None, kind: int) -> list[SettingOption]:
        if element is None:
            return []
        if len(element.children) > MAX_OPTIONS:
            self._fail(f"more than {MAX_OPTIONS} options", element)
        return [
            SettingOption(
                option.attributes.get("name", ""),
                self._value(option.attributes.get("value", ""), kind, option),
                self._texts(option, "exclusions", "exclude"),
                tuple(self._ranges(option)),
            )
            for option in element.named("option")
        ]

    def _ranges(self, option: Element) -> list[OptionRange]:
        parent = option.first("parameterranges")
        return [
            OptionRange(
                element.attributes.get("parameter", ""),
                {
                    each.attributes.get("name", ""): self._any_value(each.attributes.get("value", ""))
                    for each in element.named("roption")
                },
                element.attributes.get("condition", ""),
            )
            for element in (parent.named("parameterrange") if parent is not None else ())
        ]

    def _value(self, text: str, kind: int, element: Element) -> SettingValue:
        if kind == _KIND.CUSTOM:
            return text
        value = number(text, kind)
        if value is None:
            self._fail(f"{text!r} is no value of its type", element)
        return value

    @staticmethod
    def _any_value(text: str) -> SettingValue:
        """Return a value of a setting whose type is not known here."""
        whole = number(text, _KIND.INT64)
        real = number(text, _KIND.REAL64) if whole is None else whole
        return text if real is None else real

    def _limit(self, element: Element, name: str) -> float | None:
        text = element.attributes.get(name)
        if text is None:
            return None
        value = number(text, _KIND.REAL64)
        if value is None:
            self._fail(f"{name}={text!r} is no number", element)
        return value

    @staticmethod
    def _texts(element: Element, group: str, tag: str) -> tuple[str, ...]:
        parent = element.first(group)
        return () if parent is None else tuple(each.text for each in parent.named(tag))

    def _fail(self, problem: str, element: Element) -> NoReturn:
        raise DialectError(problem, self._path, element.line)


def _text(element: Element | None) -> str:
    return "" if element is None else element.text
