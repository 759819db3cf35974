from __future__ import annotations

import zipfile
from array import array
from math import nan

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.files.elevation import MAX_LOADED, HgtFolder

EDGE = 1201


def slope(edge: int = EDGE) -> bytes:
    """Return the content of a file whose heights fall by a metre per row and rise by two per column."""
    heights = array("h")
    for row in range(edge):
        start = 5000 - row
        heights.extend(range(start, start + 2 * edge, 2))
    heights.byteswap()
    return heights.tobytes()


CONTENT = slope()


def folder_with(tmp_path, *names: str) -> HgtFolder:
    for name in names:
        (tmp_path / name).write_bytes(CONTENT)
    return HgtFolder(tmp_path)


def test_heights_between_the_points(tmp_path):
    heights = folder_with(tmp_path, "N47E008.hgt", "readme.txt")
    assert len(heights) == 1
    assert heights(47.0, 8.0) == 5000 - 1200  # the south-western corner
    assert heights(47.5, 8.0) == pytest.approx(5000 - 600)
    assert heights(47.5, 8 + 0.25 / 1200) == pytest.approx(5000 - 600 + 0.5)
    assert heights(48 - 1e-9, 9 - 1e-9) == pytest.approx(5000 + 2400, abs=1e-3)


def test_south_and_west(tmp_path):
    heights = folder_with(tmp_path, "s01w001.HGT")
    assert heights(-1.0, -1.0) == 3800
    assert heights(-0.5, -0.5) == pytest.approx(5000 - 600 + 1200)


def test_positions_without_a_file(tmp_path):
    heights = folder_with(tmp_path, "N47E008.hgt")
    for place in ((46.99, 8.5), (47.5, 9.01), (nan, 8.0)):
        assert heights(*place) is None


def test_unknown_heights(tmp_path):
    content = bytearray(CONTENT)
    middle = 2 * (600 * EDGE + 600)
    content[middle : middle + 2] = (-32_768).to_bytes(2, "big", signed=True)
    (tmp_path / "N00E000.hgt").write_bytes(content)
    heights = HgtFolder(tmp_path)
    assert heights(0.5 - 0.1 / 1200, 0.5) is None
    assert heights(0.5 - 2.1 / 1200, 0.5) is not None


def test_zipped_files(tmp_path):
    with zipfile.ZipFile(tmp_path / "N47E008.hgt.zip", "w") as archive:
        archive.writestr("N47E008.hgt", CONTENT)
    assert HgtFolder(tmp_path)(47.0, 8.0) == 3800


@pytest.mark.parametrize("content", [b"", b"\0" * 100, CONTENT + b"\0"])
@pytest.mark.parametrize("name", ["N47E008.hgt", "N47E008.hgt.zip"])
def test_a_damaged_file_has_no_heights(tmp_path, caplog, name, content):
    (tmp_path / name).write_bytes(content)
    heights = HgtFolder(tmp_path)
    assert heights(47.5, 8.5) is None
    assert heights(47.5, 8.5) is None
    assert caplog.text.count(f"cannot open {tmp_path / name}: ") == 1


def test_an_archive_of_several_files(tmp_path):
    with zipfile.ZipFile(tmp_path / "N47E008.hgt.zip", "w") as archive:
        archive.writestr("one", b"")
        archive.writestr("two", b"")
    assert HgtFolder(tmp_path)(47.5, 8.5) is None


def test_few_files_are_kept_in_memory(tmp_path):
    heights = folder_with(tmp_path, *(f"N0{number}E000.hgt" for number in range(MAX_LOADED + 2)))
    for number in range(MAX_LOADED + 2):
        assert heights(number + 0.5, 0.5) is not None
    assert len(heights._loaded) == MAX_LOADED


def test_wrong_folders(tmp_path):
    with pytest.raises(InvalidArgumentError, match=r"has no \.hgt files"):
        HgtFolder(tmp_path)
    with pytest.raises(FileNotFoundError):
        HgtFolder(tmp_path / "missing")
