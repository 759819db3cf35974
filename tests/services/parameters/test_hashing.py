"""The hash is PX4's: reflected CRC-32 from 0, without final inversion."""

from __future__ import annotations

from struct import pack

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.services.parameters import Parameter, ParameterDefinition, ParameterTable, hash_of


def by_bits(data: bytes) -> int:
    state = 0
    for byte in data:
        state ^= byte
        for _ in range(8):
            state = state >> 1 ^ (0xEDB88320 if state & 1 else 0)
    return state


@given(st.lists(st.tuples(st.text("ABC_", min_size=1, max_size=16), st.integers(-(1 << 31), (1 << 31) - 1))))
def test_against_the_definition(rows) -> None:
    data = b"".join(name.encode() + pack("<i", value) for name, value in rows)
    assert hash_of(Parameter(name, value, common.MavParamType.INT32) for name, value in rows) == by_bits(data)


def test_floats_go_in_as_float32_and_nothing_is_zero() -> None:
    assert hash_of([Parameter("MC_ROLL_P", 6.5)]) == by_bits(b"MC_ROLL_P" + pack("<f", 6.5))
    assert hash_of([]) == 0


def test_volatile_parameters_are_left_out() -> None:
    table, other = ParameterTable(), ParameterTable()
    table.add(ParameterDefinition("A", 1))
    other.add(ParameterDefinition("A", 1))
    table.add(ParameterDefinition("LND_FLIGHT_T_LO", 77, volatile=True))
    assert table.hash() == other.hash()
