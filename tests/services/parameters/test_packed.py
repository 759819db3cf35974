"""ArduPilot's packed file, against pymavlink's reader, and damaged."""

from __future__ import annotations

from random import Random
from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.mavftp import MAVFTP

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.parameters import Parameter, unpack, write, write_upload
from mavstack.services.parameters.value import fitted, limits

KIND = common.MavParamType
TYPES = {KIND.INT8: 1, KIND.INT16: 2, KIND.INT32: 3, KIND.REAL32: 4}
NAMES = st.text("ABC_1", min_size=1, max_size=16)


def parameters(names: list[str], seed: int) -> list[Parameter]:
    random = Random(seed)
    made = []
    for index, name in enumerate(names):
        kind = random.choice(list(TYPES))
        value = (
            fitted(random.uniform(-1e6, 1e6), kind) if kind == KIND.REAL32 else random.randint(*limits(kind))
        )
        made.append(Parameter(name, value, kind, index))
    return made


@given(st.lists(NAMES, unique=True, max_size=60), st.integers(), st.sampled_from([None, 80, 110, 239]))
def test_what_is_written_is_read(names, seed, block_size) -> None:
    wanted = parameters(names, seed)
    packed = unpack(write(wanted, block_size=block_size))
    assert packed is not None
    assert list(packed.parameters) == wanted
    assert [parameter.index for parameter in packed.parameters] == list(range(len(wanted)))
    assert packed.complete


@given(
    st.lists(NAMES, unique=True, max_size=60), st.integers(), st.sampled_from([None, 80, 239]), st.booleans()
)
def test_pymavlink_reads_it_alike(names, seed, block_size, with_defaults) -> None:
    wanted = parameters(names, seed)
    defaults = {p.name: p.value if seed % 2 else fitted(1, p.type) for p in wanted} if with_defaults else None
    data = write(wanted, block_size=block_size, defaults=defaults)
    theirs, ours = MAVFTP.ftp_param_decode(data), unpack(data)
    assert theirs is not None
    assert ours is not None
    expected = [(p.name.encode(), p.value, TYPES[p.type]) for p in wanted]  # type: ignore[index]
    assert theirs.params == expected
    assert [(p.name.encode(), p.value, TYPES[p.type]) for p in ours.parameters] == expected  # type: ignore[index]
    if with_defaults:
        assert ours.defaults == {name.decode(): value for name, value, _ in theirs.defaults or ()} == defaults


@given(st.lists(NAMES, unique=True, min_size=20, max_size=60), st.integers(), st.sampled_from([16, 80, 239]))
def test_no_value_lies_across_two_blocks(names, seed, block_size) -> None:
    wanted = [Parameter(p.name, 0x01020304, KIND.INT32) for p in parameters(names, seed)]
    data = write(wanted, block_size=block_size)
    at = data.find(b"\4\3\2\1")
    while at >= 0:
        assert at // block_size == (at + 3) // block_size
        at = data.find(b"\4\3\2\1", at + 4)


def test_bytes_by_hand() -> None:
    entries = b"\x02\x30ARMX" + pack("<h", -2) + b"\0\0\0" + b"\x14\x23ZQT" + pack("<ff", 0.5, 1.5)
    packed = unpack(pack("<HHH", 0x671C, 2, 9) + entries, start=3)
    assert packed is not None
    assert packed.parameters == (Parameter("ARMX", -2, KIND.INT16), Parameter("ARMZQT", 0.5, KIND.REAL32))
    assert packed.defaults == {"ARMX": -2, "ARMZQT": 1.5}
    assert (packed.total, packed.complete, packed.parameters[0].index) == (9, False, 3)


@given(st.binary(max_size=200))
def test_garbage_is_no_packed_file_or_some(data) -> None:
    for header in (b"", pack("<HHH", 0x671B, 1, 1), pack("<HHH", 0x671C, 3, 3)):
        packed = unpack(header + data)
        assert packed is None or len(packed.parameters) <= 65535


def test_cut_files_are_none() -> None:
    data = write(parameters(["ABC", "ABD", "B"], 1))
    assert all(unpack(data[:length]) is None for length in range(len(data)))
    assert unpack(data + b"\0\0") is not None
    assert unpack(data + b"\1") is None


def test_other_types_become_wider() -> None:
    rows = [
        Parameter("A", 255, KIND.UINT8),
        Parameter("B", 65535, KIND.UINT16),
        Parameter("C", 1 << 31, KIND.UINT32),
        Parameter("D", 5, KIND.UINT32),
        Parameter("E", 0.5, KIND.REAL64),
    ]
    packed = unpack(write(rows))
    assert packed is not None
    kinds = [KIND.INT16, KIND.INT32, KIND.REAL32, KIND.INT32, KIND.REAL32]
    assert [parameter.type for parameter in packed.parameters] == kinds
    assert [parameter.value for parameter in packed.parameters] == [255, 65535, float(1 << 31), 5, 0.5]


def test_an_upload_begins_with_its_length_and_is_read() -> None:
    wanted = parameters(["ABC", "ABD", "B"], 2)
    data = write_upload(wanted)
    assert data[4:6] == pack("<H", len(data))
    packed = unpack(data)
    assert packed is not None
    assert list(packed.parameters) == wanted


def test_a_name_that_is_too_long_raises() -> None:
    with pytest.raises(InvalidArgumentError, match="16 bytes"):
        write([Parameter("A" * 17, 1.0)])
