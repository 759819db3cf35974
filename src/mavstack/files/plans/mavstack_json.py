"""Mavstack's JSON format, which holds every plan without loss; `mav mission show --json` prints it.

    {"fileType": "MavstackPlan", "version": 1, "home": {"latitude", "longitude", "altitude"} or null,
     "vehicle": {"firmware", "vehicle_type", "cruise_speed", "hover_speed"},
     "mission": [item, …], "fence": [item, …], "rally": [item, …]}

An item is {"seq", "command", "name", "frame", "params": [7 numbers], "autocontinue"}. `seq` is its index in
the list, from 0, which a DO_JUMP refers to; the name is for people. NaN is null, infinities are "inf" and
"-inf". Unknown keys are ignored.
"""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, Final

from mavstack.files.plans.json_tree import JsonValue, as_json
from mavstack.files.plans.model import Home, PlanFile, Settings, item_of, params_of
from mavstack.files.plans.parsing import bounded

if TYPE_CHECKING:
    from mavstack.files.plans.parsing import Report
    from mavstack.services.mission import MissionItem

FILE_TYPE: Final = "MavstackPlan"
VERSION: Final = 1


def recognise(text: str) -> bool:
    """Return whether the text begins as a file of this format."""
    return text.lstrip().startswith("{") and f'"{FILE_TYPE}"' in text[:4096]


def parse(text: str, name: str = "") -> PlanFile:
    """Read the text of a file."""
    root = JsonValue.parse(text, name)
    version = root.get("version")
    if version.integer(0, 10**9) != VERSION:
        raise version.wrong(f"version {version.value} is not supported, only {VERSION}")
    home = root.find("home")
    items = {key: bounded(_items(root, key), name) for key in ("mission", "fence", "rally")}
    read = PlanFile.of(items["mission"], items["fence"], items["rally"], _home(home))
    return replace(read, settings=_settings(root.find("vehicle")))


def write(plan: PlanFile, report: Report) -> str:
    """Write a plan as text."""
    return json.dumps(plan_json(plan), indent=2, allow_nan=False) + "\n"


def plan_json(plan: PlanFile) -> dict[str, Any]:
    """Return a plan as a JSON object of this format."""
    home = plan.home
    return {
        "fileType": FILE_TYPE,
        "version": VERSION,
        "home": None if home is None else {key: as_json(value) for key, value in asdict(home).items()},
        "vehicle": asdict(plan.settings),
        "mission": [item_json(seq, item) for seq, item in enumerate(plan.mission.items)],
        "fence": [item_json(seq, item) for seq, item in enumerate(plan.fence.items)],
        "rally": [item_json(seq, item) for seq, item in enumerate(plan.rally.items)],
    }


def item_json(seq: int, item: MissionItem) -> dict[str, Any]:
    """Return an item as a JSON object."""
    return {
        "seq": seq,
        "command": int(item.command),
        "name": item.name,
        "frame": int(item.frame),
        "params": [as_json(value) for value in params_of(item)],
        "autocontinue": item.autocontinue,
    }


def _items(root: JsonValue, key: str) -> list[MissionItem]:
    found = root.find(key)
    return [] if found is None else [_item(tree) for tree in found.elements()]


def _item(tree: JsonValue) -> MissionItem:
    proceeds = tree.find("autocontinue")
    return item_of(
        tree.get("command").integer(0, 0xFFFF),
        tree.get("params").numbers(7),
        tree.get("frame").integer(0, 0xFF),
        autocontinue=True if proceeds is None else proceeds.flag(),
    )


def _home(tree: JsonValue | None) -> Home | None:
    if tree is None or tree.value is None:
        return None
    altitude = tree.find("altitude")
    place = (tree.get("latitude").finite(), tree.get("longitude").finite())
    return Home(*place, 0.0 if altitude is None else altitude.finite())


def _settings(tree: JsonValue | None) -> Settings:
    if tree is None:
        return Settings()
    found = {key: tree.find(key) for key in ("firmware", "vehicle_type", "cruise_speed", "hover_speed")}
    held = {key: value for key, value in found.items() if value is not None and value.value is not None}
    numbers = {key: value.integer(0, 255) for key, value in held.items() if not key.endswith("speed")}
    speeds = {key: value.finite() for key, value in held.items() if key.endswith("speed")}
    return Settings(
        numbers.get("firmware"),
        numbers.get("vehicle_type"),
        speeds.get("cruise_speed"),
        speeds.get("hover_speed"),
    )
