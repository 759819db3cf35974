"""Metadata of parameters: templates, ranges, named values and bits."""

from __future__ import annotations

import copy
import pickle
from math import inf, nan

import pytest

from mavstack.services.parameters import MetadataTable, ParameterMetadata

RANGE = ParameterMetadata(name="A", unit="m", minimum=0, maximum=0.3, default=-1)
VALUES = ParameterMetadata(name="B", values={0: "Off", 2: "On"})
BITS = ParameterMetadata(name="C", bitmask={0: "Roll", 1: "Pitch", 4: "Yaw"})


@pytest.mark.parametrize(
    ("metadata", "allowed", "problems"),
    [
        (
            RANGE,
            [0, 0.1, 0.3, 0.30000001192092896, -1],
            {1: "1 is outside of its range 0 to 0.3 m", nan: "nan is not a finite number"},
        ),
        (ParameterMetadata(name="A", minimum=5), [5, 1e30], {4: "4 is outside of its range at least 5"}),
        (ParameterMetadata(name="A", maximum=5), [5, -7], {inf: "inf is not a finite number"}),
        (VALUES, [0, 2, 2.0], {1: "1 is not one of its values 0 (Off), 2 (On)"}),
        (ParameterMetadata(name="B", values={0.6: "Strict", 0.8: "Loose"}), [0.7, 3], {}),
        (
            ParameterMetadata(name="B", values={0: "Off"}, minimum=2, maximum=3),
            [0, 2.5],
            {1: "1 is outside of its range 2 to 3"},
        ),
        (
            BITS,
            [0, 1, 3, 19],
            {
                4: "4 sets bit 2, which is not one of its bits 0, 1, 4",
                0.5: "0.5 is not a whole number, which a bitmask must be",
            },
        ),
        (ParameterMetadata(name="C", read_only=True), [], {1: "it is read-only"}),
        (ParameterMetadata(name="D"), [nan, 1e9], {}),
    ],
)  # fmt: skip
def test_problems(metadata, allowed, problems):
    for value in allowed:
        assert metadata.problem(value) is None, value
    for value, problem in problems.items():
        assert metadata.problem(value) == problem


def test_names_of_values():
    assert (VALUES.describe(2), VALUES.describe(1)) == ("On", "")
    assert (BITS.describe(17), BITS.describe(0), BITS.describe(nan)) == ("Roll, Yaw", "", "")


def test_table_finds_templates():
    template = ParameterMetadata(name="RC{n}_MIN", short_description="Channel {n}", minimum=800, maximum=1500)
    table = MetadataTable([RANGE, template], "here")
    assert table["RC12_MIN"].short_description == "Channel 12"
    assert table["RC12_MIN"].name == "RC12_MIN"
    assert list(table) == ["A"]
    assert "RC1_MIN" in table
    assert table.get("RCX_MIN") is None
    assert table.problem("RC3_MIN", 5) == "5 is outside of its range 800 to 1500"
    assert table.problem("UNKNOWN", 5) is None
    assert (bool(table), bool(MetadataTable())) == (True, False)


def test_metadata_is_a_value():
    assert pickle.loads(pickle.dumps(VALUES)) == VALUES == copy.deepcopy(VALUES)
    assert len({VALUES, BITS, RANGE}) == 3
