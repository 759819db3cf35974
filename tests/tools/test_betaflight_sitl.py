from __future__ import annotations

from typing import TYPE_CHECKING

from tools.betaflight_sitl import PINS, PLATFORM, TARGET_HEADER, prepare, with_equipment

if TYPE_CHECKING:
    from pathlib import Path

HEADER = "#define USE_ACC\n#undef USE_OSD\n#undef USE_OSD_EXTRA\n#undef USE_VTX_COMMON\n"


def test_equipment_is_not_switched_off() -> None:
    assert with_equipment(HEADER) == "#define USE_ACC\n#undef USE_OSD_EXTRA\n"


def test_a_source_is_copied_and_left_as_it_is(tmp_path: Path) -> None:
    source, folder = tmp_path / "source", tmp_path / "cache" / "betaflight"
    (source / TARGET_HEADER).parent.mkdir(parents=True)
    (source / TARGET_HEADER).write_text(HEADER)
    (source / PLATFORM).write_text("int x;\n")
    for _ in range(2):  # the second time nothing is left to do
        prepare(source, folder)
        assert (source / TARGET_HEADER).read_text() == HEADER
        assert (folder / TARGET_HEADER).read_text() == with_equipment(HEADER)
        assert (folder / PLATFORM).read_text() == "int x;\n" + PINS
        assert (folder / "src" / "config" / ".git").exists()
