"""A layout for Foxglove that shows a vehicle at once: `layout.json`, with the namespace of the vehicle."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bridges.core.names import VehicleNames

if TYPE_CHECKING:
    from pathlib import Path

#: The vehicle namespace in the layout file.
_WRITTEN: Final = f"{VehicleNames().namespace}/"

#: The text before each frame name in the layout file, and the frame name.
_FRAMES: Final = (
    ('"followTf": "', "base_link"),
    ('"frameId": "', "map"),
    ('"frame:', "map"),
    ('"frame:', "base_link"),
)


def layout_text(namespace: str = "") -> str:
    """Return the layout.

    Args:
        namespace: The namespace of the vehicle, such as "/alpha/mavros"; empty: "/mavros".

    Returns:
        The JSON that Foxglove imports.
    """
    text = (files("mavstack.bridges.foxglove") / "layout.json").read_text("utf-8")
    prefix = namespace.removesuffix(_WRITTEN.rstrip("/")).strip("/")
    if prefix:
        text = text.replace(f'"{_WRITTEN}', f'"/{prefix}{_WRITTEN}')
        for before, frame in _FRAMES:
            text = text.replace(f"{before}{frame}", f"{before}{prefix}/{frame}")
    return text


def write_layout(path: Path, namespace: str) -> None:
    """Write the layout of a vehicle into a file."""
    write_file_atomically(path, layout_text(namespace).encode())


def topics_of(layout: dict[str, Any]) -> set[str]:
    """Return the topics and services that the panels of a layout show."""
    return {
        text.partition(".")[0]
        for config in layout["configById"].values()
        for text in _texts(config)
        if text.startswith("/")
    }


def _texts(value: object) -> list[str]:
    if isinstance(value, str):
        return [value]
    if isinstance(value, dict):
        return [text for key, each in value.items() for text in (*_texts(key), *_texts(each))]
    if isinstance(value, list):
        return [text for each in value for text in _texts(each)]
    return []
