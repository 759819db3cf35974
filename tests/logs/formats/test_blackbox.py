"""Recognition of Blackbox logs."""

from __future__ import annotations

import pytest

from mavstack.logs.formats.blackbox import BLACKBOX

MARKER = b"H Product:Blackbox flight data recorder by Nicholas Sherlock\n"


@pytest.mark.parametrize(
    ("head", "matches"),
    [
        (MARKER, True),
        (bytes(5000) + MARKER, True),
        (bytes(50_000) + MARKER, False),
        (b"H Product:Black box\n", False),
        (b"", False),
    ],
)
def test_a_blackbox_log_is_recognised_by_its_first_line(head, matches):
    assert BLACKBOX.matches(head) is matches
