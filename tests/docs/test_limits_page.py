"""The page of limits says what the code does."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

from mavstack.links import open_link
from mavstack.security.admission import AUTHENTICATED_TIMEOUT, MIN_STAY, USE_TIMEOUT

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "limits.md").read_text("utf-8")
ROWS = re.findall(r"^\| (.+?) \| (\d+) \| `([\w.]+)` \|$", PAGE, re.MULTILINE)


@pytest.mark.parametrize(("about", "bound", "name"), ROWS)
def test_a_bound_is_that_of_its_constant(about, bound, name):
    module, _, constant = name.rpartition(".")
    assert float(bound) == getattr(import_module(module), constant), about


def test_the_page_has_the_bounds_of_links_and_the_times_of_the_admission():
    assert len(ROWS) > 25
    assert open_link("udpin://127.0.0.1:0").max_peers == 256
    assert open_link("tcpin://127.0.0.1:0").max_peers == 64
    assert f"not used for {USE_TIMEOUT:g} s ({AUTHENTICATED_TIMEOUT:g} s if" in PAGE
    assert f"each has {MIN_STAY:g} s on average" in PAGE
