"""A program for Python with rclpy: all types of the table, by rclpy's own decoder and hashes.

The last line is JSON: the number of types and hashes, and the problems found.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from pathlib import Path
from random import Random
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from mavstack.bridges.core.table import ALL
from mavstack.bridges.core.types import Definition, codec_of, definition_of, type_hash
from mavstack.bridges.core.types.cdr import nest
from mavstack.bridges.ros2.rclpy_sink import _parts
from tests.bridges.core.types.random_values import random_values


def message_class(name: str) -> Any:
    package, kind, short = name.split("/")
    found = import_module(f"{package}.{kind}")
    if kind == "srv":
        service, _, part = short.rpartition("_")
        return getattr(getattr(found, service), part)
    if kind == "action" and "_SendGoal" not in short and "_GetResult" not in short:
        action, _, part = short.partition("_")
        owner = getattr(found, action)
        return owner.Impl.FeedbackMessage if part == "FeedbackMessage" else getattr(owner, part)
    for part in _parts(short, kind) if kind == "action" else [short]:
        found = getattr(found, part)
    return found


def value_of(value: Any) -> Any:
    """Return a value of rclpy as plain Python."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: value_of(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes) and len(value) == 1:
        return value[0]
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [value_of(each) for each in value]
    return value


def plain(value: Any) -> Any:
    """Return a value of ours as plain Python, with sequences as lists."""
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple | bytes):
        return [plain(each) for each in value]
    return value


def needed() -> set[str]:
    """Return the names of all messages that the rows send or take."""
    found: set[str] = set()
    for row in ALL:
        kind = row.type.split("/")[1]
        parts = {"msg": ("",), "srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}
        found |= {row.type + part for part in parts[kind]}
    return found


def without_empty(fields: dict[str, Any], definition: Definition) -> dict[str, Any]:
    return {} if definition.fields[0].name.startswith("structure_needs") else fields


def check(name: str, problems: list[str]) -> None:
    rng = Random(name)
    definition = definition_of(name)
    kind = message_class(name)
    for _ in range(3):
        values = random_values(name, rng)
        payload = codec_of(name).encode(values)
        message = deserialize_message(payload, kind)
        ours = without_empty(plain(nest(definition, values)), definition)
        theirs = without_empty(value_of(message), definition)
        if json.dumps(ours, sort_keys=True) != json.dumps(theirs, sort_keys=True):
            problems.append(f"{name}: {ours} is read as {theirs}")
        back = bytes(serialize_message(message))
        if codec_of(name).decode(back) != values and ours:
            problems.append(f"{name}: rclpy writes other bytes")


def check_hashes(problems: list[str]) -> int:
    """Compare with the hashes that rosidl wrote beside the definitions."""
    count = 0
    for folder in sys.path:
        for path in Path(folder).parents[2:3] if folder.endswith("site-packages") else ():
            for file in path.glob("share/*/*/*.json"):
                for entry in json.loads(file.read_text("utf-8")).get("type_hashes", []):
                    try:
                        ours = type_hash(entry["type_name"])
                    except ValueError:
                        continue
                    count += 1
                    if ours != entry["hash_string"]:
                        problems.append(f"{entry['type_name']}: {ours}, not {entry['hash_string']}")
    return count


def main() -> None:
    problems: list[str] = []
    names = sorted(needed())
    for name in names:
        try:
            check(name, problems)
        except Exception as error:  # noqa: BLE001 (each type is reported)
            problems.append(f"{name}: {type(error).__name__} {error}")
    hashes = check_hashes(problems)
    print(json.dumps({"types": len(names), "hashes": hashes, "problems": problems[:20]}))


if __name__ == "__main__":
    main()
