"""The modules of the runtime, whose readers and writers are alike for all types of numbers."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.languages.typescript.fields import WIDE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library
    from mavstack.codegen.templates import Templates

_MODULES: Final = (
    "builder",
    "crc",
    "enums",
    "message",
    "packet",
    "parser",
    "read",
    "sha256",
    "signing",
    "table",
    "utf8",
    "write",
)
#: Numbers: name of the functions, name in the methods of DataView, size in bytes, C type.
_NUMBERS: Final = (
    ("u8", "Uint8", 1, "uint8_t"),
    ("i8", "Int8", 1, "int8_t"),
    ("u16", "Uint16", 2, "uint16_t"),
    ("i16", "Int16", 2, "int16_t"),
    ("u32", "Uint32", 4, "uint32_t"),
    ("i32", "Int32", 4, "int32_t"),
    ("u64", "BigUint64", 8, "uint64_t"),
    ("i64", "BigInt64", 8, "int64_t"),
    ("f32", "Float32", 4, "float"),
    ("f64", "Float64", 8, "double"),
)


def runtime_files(templates: Templates, library: Library) -> Iterator[GeneratedFile]:
    """Yield the modules of the runtime."""
    for name in _MODULES:
        yield templates.file(
            f"src/runtime/{name}.ts", f"runtime/{name}.ts.j2", library=library, **_functions()
        )


@cache
def _functions() -> dict[str, str]:
    """Return the readers and writers of numbers, by the names of template variables."""
    several = [row for row in _NUMBERS if row[2] > 1]
    arrays = [row for row in _NUMBERS if row[0] != "u8"]
    return {
        "readers": "\n".join([*map(_reader, several), *map(_array_reader, arrays)]),
        "integer_writers": "\n".join(
            _integer_writer(*row) for row in _NUMBERS if row[2] <= 4 and "nt" in row[1]
        ),
        "array_writers": "\n".join(map(_array_writer, arrays)),
    }


def _type(c_name: str) -> str:
    return "bigint" if c_name in WIDE else "number"


def _reader(row: tuple[str, str, int, str]) -> str:
    name, method, size, c_name = row
    return f"""
export function {name}(view: DataView, at: number, end: number): {_type(c_name)} {{
  return at + {size} <= end ? view.get{method}(at, true) : partial(view, at, end).get{method}(0, true);
}}"""


def _array_reader(row: tuple[str, str, int, str]) -> str:
    name, method, size, c_name = row
    little = ", true" if size > 1 else ""
    return f"""
export function {name}Array(view: DataView, at: number, end: number, length: number): {_type(c_name)}[] {{
  const values = new Array<{_type(c_name)}>(length);
  if (at + {size} * length <= end) {{
    for (let i = 0; i < length; i++) values[i] = view.get{method}(at + {size} * i{little});
  }} else {{
    for (let i = 0; i < length; i++) values[i] = {name}(view, at + {size} * i, end);
  }}
  return values;
}}"""


def _integer_writer(name: str, method: str, size: int, c_name: str) -> str:
    bits = 8 * size
    low, high = (0, (1 << bits) - 1) if name.startswith("u") else (-(1 << bits - 1), (1 << bits - 1) - 1)
    little = ", true" if size > 1 else ""
    return f"""
export function {name}(view: DataView, at: number, value: number, field: string): void {{
  if (!(value >= {low} && value <= {high})) refuse(field, value, "{c_name}");
  view.set{method}(at, value{little});
}}"""


def _array_writer(row: tuple[str, str, int, str]) -> str:
    name, _, size, c_name = row
    values = f"values: ArrayLike<{_type(c_name)}>, field: string"
    return f"""
export function {name}Array(view: DataView, at: number, length: number, {values}): void {{
  checkLength(values, length, field);
  for (let i = 0; i < values.length; i++) {name}(view, at + {size} * i, values[i]!, field);
}}"""
