"""The import of commands."""

from __future__ import annotations

import gc
import sys
from types import ModuleType
from typing import TYPE_CHECKING

from mavstack.cli import registry
from mavstack.cli.registry import COMMANDS, load_command

if TYPE_CHECKING:
    import pytest


def test_a_command_is_imported_once_without_the_cycle_collector(monkeypatch: pytest.MonkeyPatch) -> None:
    name = COMMANDS["bridge"].module
    imported: list[tuple[str, bool]] = []
    made = ModuleType(name)

    def import_module(name: str) -> ModuleType:
        imported.append((name, gc.isenabled()))
        sys.modules[name] = made
        return made

    monkeypatch.setitem(sys.modules, name, made)  # restored at the end
    del sys.modules[name]
    monkeypatch.setattr(registry, "import_module", import_module)
    monkeypatch.setattr(gc, "freeze", lambda: None)
    assert load_command("bridge") is load_command("bridge") is made
    assert imported == [(name, False)]
    assert gc.isenabled()
