"""Editors complete names: jedi finds the API behind `mavstack.`, and a vehicle's behind `vehicle.`."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import mavstack

if TYPE_CHECKING:
    from collections.abc import Iterator

jedi = pytest.importorskip("jedi")

SOURCE = Path(__file__).parents[2] / "src"
PROGRAMS = {
    "import mavstack\nmavstack.": {"connect", "Node", "Parser", "open_log", "RemoteTimeout"},
    "import mavstack\nasync def main():\n    async with mavstack.connect('x') as connection:\n"
    "        connection.": {"wait_for_vehicle", "group"},
    "import mavstack\nasync def main():\n    async with mavstack.connect('x') as connection:\n"
    "        vehicle = await connection.wait_for_vehicle()\n        vehicle.": {"arm", "takeoff", "position"},
    "import mavstack.sync\nwith mavstack.sync.connect('x') as connection:\n"
    "    vehicle = connection.wait_for_vehicle()\n    vehicle.": {"arm", "takeoff", "component"},
    "from mavstack.sync import Vehicle\ndef fly(vehicle: Vehicle):\n    vehicle.": {"arm", "takeoff"},
    "import mavstack\nlog = mavstack.open_log('x')\nlog['ATTITUDE'].": {"to_pandas", "frame"},
    "from mavstack.dialects import common\ncommon.Attitude().": {"roll", "to_dict"},
}


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the cache of jedi, which several processes cannot write at once, in a folder of this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(jedi.settings, "cache_directory", str(tmp_path_factory.mktemp("jedi")))
        yield


# One process parses the sources for all of them.
@pytest.mark.xdist_group("completions")
@pytest.mark.parametrize("program", PROGRAMS)
def test_an_editor_completes_names(program: str, tmp_path: Path) -> None:
    project = jedi.Project(tmp_path, added_sys_path=[str(SOURCE)], smart_sys_path=False)
    lines = program.split("\n")
    completions = jedi.Script(program, project=project).complete(len(lines), len(lines[-1]))
    assert {each.name for each in completions} >= PROGRAMS[program]


def test_the_names_at_top_level_are_those_of_the_stub():
    stub = (Path(mavstack.__file__).parent / "__init__.pyi").read_text("utf-8")
    imports = [node for node in ast.parse(stub).body if isinstance(node, ast.ImportFrom)]
    listed = {alias.asname: (node.module, alias.name) for node in imports for alias in node.names}
    assert sorted(listed) == mavstack.__all__
    for name, (module, original) in listed.items():
        assert name == original
        assert getattr(mavstack, name) is getattr(import_module(module), name)
        assert name in dir(mavstack)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        mavstack.nothing  # noqa: B018
