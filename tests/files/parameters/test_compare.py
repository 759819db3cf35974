from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.files.parameters import StoredParameter, compare, parse_parameters, value_text
from mavstack.services.parameters import Parameter

KIND = common.MavParamType


def stored(**values):
    return {name: StoredParameter(name, value) for name, value in values.items()}


def entry(kind=KIND.REAL32, *, exact=True, **values):
    return {name: Parameter(name, value, kind, exact=exact) for name, value in values.items()}


def test_differences_and_missing_parameters():
    found = compare(stored(A=1, B=2.5, C=3), entry(B=2.5, C=4.0, D=5.0))
    assert [each.name for each in found.different] == ["C"]
    assert found.same == ("B",)
    assert [each.name for each in found.only_ours] == ["A"]
    assert [each.name for each in found.only_theirs] == ["D"]
    assert not found.alike
    assert compare(stored(A=1), entry(A=1.0)).alike


@given(st.dictionaries(st.text("ABC_", min_size=1, max_size=5), st.floats(width=32, allow_nan=False)))
def test_a_vehicle_equals_its_saved_parameters(values):
    vehicle = entry(**values)
    file = {name: StoredParameter(name, float(value_text(each))) for name, each in vehicle.items()}
    assert compare(file, vehicle).alike


def test_a_decimal_is_the_float32_that_it_means():
    assert compare(stored(P=0.135), entry(P=0.13500000536441803)).alike
    assert not compare(stored(P=0.135), entry(P=0.13500002026557922)).alike


def test_integers_are_compared_exactly_unless_the_encoding_is_inexact():
    assert not compare(stored(ID=16777217), entry(KIND.INT32, ID=16777216)).alike
    assert compare(stored(ID=16777217), entry(KIND.INT32, exact=False, ID=16777216)).alike
    assert compare(stored(ID=97539.0), entry(KIND.INT32, ID=97539)).alike


def test_two_types_are_compared_as_the_less_precise_one():
    ours = {"A": StoredParameter("A", 16777217, KIND.INT32)}
    assert compare(ours, entry(KIND.REAL32, A=16777216.0)).alike


def test_names_match_whatever_their_case():
    found = compare(stored(rtl_alt=1, Odd=2), entry(RTL_ALT=2.0, Odd=2.0, ODD=3.0))
    assert [each.name for each in found.different] == ["RTL_ALT"]
    assert found.same == ("Odd",)
    assert [each.name for each in found.only_theirs] == ["ODD"]


def test_files_of_programs_that_round():
    vehicle = entry(P=0.12345679104328156, Q=1e-7, R=123456.7890625)
    assert compare(parse_parameters("P 0.123457\nQ 0.000000\nR 123456.789062\n").by_name(), vehicle).alike
    assert compare(parse_parameters("P,0.1234568\nR,123456.8\n").by_name(), vehicle).different == ()
    assert len(compare(parse_parameters("P,0.1234\nQ,0\nR,123457\n").by_name(), vehicle).different) == 3
