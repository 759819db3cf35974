"""Units of H.264 in packets."""

from __future__ import annotations

import pytest

from mavstack.server.video.nal_units import unit_types


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ("000001 65 88", {5}),
        ("00000001 67 42 000001 68 ce 00000001 65 88 84", {5, 7, 8}),
        ("0000000000 000001 09 f0 000001 41 9a", {1, 9}),
        ("", set()),
        ("000000", set()),
        ("ffffffff", set()),
        ("00000017 65 88", set()),
        ("ff 000001 65 88", set()),
        ("000001", set()),
        ("000001 e5 88", set()),
        ("000001 60", set()),
        ("000001 7c 88", set()),
        ("000001 65 88 000001 ff", set()),
    ],
)
def test_types_of_units(data, expected):
    assert unit_types(bytes.fromhex(data)) == expected
