"""Files name the tiers of their tests, since `make flights` and `make interop` collect no others."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.tiers import NAMES, check_that_files_name_tiers

MAKEFILE = Path("Makefile").read_text()


def item(path: Path, *markers: str) -> SimpleNamespace:
    return SimpleNamespace(path=path, name="test_it", get_closest_marker=lambda name: name in markers)


@pytest.mark.parametrize("tier", NAMES)
def test_a_marker_of_another_file_is_refused(tmp_path, tier) -> None:
    path = tmp_path / "test_file.py"
    path.write_text(f"from elsewhere import MARKS  # {tier}\n")
    check_that_files_name_tiers([item(path)])
    with pytest.raises(pytest.UsageError, match=f"test_it is marked {tier}"):
        check_that_files_name_tiers([item(path, tier)])


@pytest.mark.parametrize(
    ("tier", "text"), [("interop", "interop"), ("flight", "flight"), ("flight", "fast_cases(1)")]
)
def test_a_file_names_its_tier(tmp_path, tier, text) -> None:
    path = tmp_path / "test_file.py"
    path.write_text(f"pytestmark = pytest.mark.{text}\n")
    check_that_files_name_tiers([item(path, tier)])


def test_the_makefile_looks_for_the_same_names() -> None:
    for pattern in NAMES.values():
        markers = pattern.partition("(")[2].partition(")")[0]
        assert f"$(call files_marked,{markers}" in MAKEFILE
