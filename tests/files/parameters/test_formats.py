from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import ParameterFileError
from mavstack.files.parameters import FORMATS, ParameterFile, StoredParameter, parse_parameters
from mavstack.services.parameters.value import limits

KIND = common.MavParamType
NAMES = st.text("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789", min_size=1, max_size=16)
REALS = st.floats(width=32, allow_nan=False)


@st.composite
def typed(draw):
    kind = draw(st.sampled_from(list(KIND)))
    if kind == KIND.REAL64:
        value = draw(st.floats(allow_nan=False))
    elif kind == KIND.REAL32:
        value = draw(REALS)
    else:
        value = draw(st.integers(*limits(kind)))
    return kind, value


@st.composite
def plain_files(draw):
    values = draw(st.lists(st.one_of(st.integers(-(1 << 31), (1 << 32) - 1), REALS), min_size=1, max_size=20))
    names = draw(st.lists(NAMES, min_size=len(values), max_size=len(values), unique=True))
    marks = draw(st.lists(st.booleans(), min_size=len(values), max_size=len(values)))
    return ParameterFile(
        tuple(
            StoredParameter(name, value, read_only=mark)
            for name, value, mark in zip(names, values, marks, strict=True)
        )
    )


@st.composite
def qgc_files(draw):
    values = draw(st.lists(typed(), min_size=1, max_size=20))
    names = draw(st.lists(NAMES, min_size=len(values), max_size=len(values), unique=True))
    components = draw(st.lists(st.integers(1, 255), min_size=len(values), max_size=len(values)))
    return ParameterFile(
        tuple(
            StoredParameter(name, value, int(kind), component)
            for name, (kind, value), component in zip(names, values, components, strict=True)
        ),
        draw(st.integers(1, 255)),
    )


def as_float32(parameter):
    from mavstack.files.parameters.numbers import as_single

    value = parameter.value
    single = as_single(value) if isinstance(value, float) else value
    return (parameter.name, parameter.type, parameter.component, parameter.read_only, single)


@pytest.mark.parametrize("name", ["mission-planner", "mavproxy"])
@given(file=plain_files())
def test_plain_round_trips(name, file):
    text = FORMATS[name].write(file)
    back = parse_parameters(text)
    assert [as_float32(each) for each in back.parameters] == [as_float32(each) for each in file.parameters]
    assert FORMATS[name].write(back) == text


@given(qgc_files())
def test_qgroundcontrol_round_trips(file):
    text = FORMATS["qgroundcontrol"].write(file)
    back = parse_parameters(text)
    assert back.system == file.system
    exact = [each.value for each in file.parameters if each.type == KIND.REAL64]
    assert [each.value for each in back.parameters if each.type == KIND.REAL64] == exact
    assert [as_float32(each) for each in back.parameters] == [as_float32(each) for each in file.parameters]
    assert FORMATS["qgroundcontrol"].write(back) == text


@given(plain_files())
def test_px4_scripts_round_trip(file):
    text = FORMATS["px4-script"].write(file)
    assert FORMATS["px4-script"].write(parse_parameters(text)) == text


def problem_of(text):
    """Return the error text; empty if the text was read."""
    try:
        return "" if parse_parameters(text).parameters else "nothing was read"
    except ParameterFileError as error:
        return str(error)


@given(st.text(max_size=200))
def test_random_text_is_read_or_refused_in_one_line(text):
    problem = problem_of(text)
    assert problem.isprintable()
    assert len(problem) < 600


@given(
    st.lists(
        st.sampled_from(
            ["A", "1", "1.5", "\t", ",", " ", "=", "#", "\n", "\r", "@READONLY", "param set", "9"]
        )
    )
)
def test_invalid_words(words):
    assert problem_of("".join(words)).isprintable()


def values(text, **options):
    return {each.name: each.value for each in parse_parameters(text, **options).parameters}


def test_mission_planner():
    text = (
        "\ufeff#NOTE: 5/1/2024 a note\r\nACRO_LOCKING,0\r\nARSPD_RATIO,1.994\r\n\r\n# b\r\nRTL_ALT , 3000\r\n"
    )
    assert values(text) == {"ACRO_LOCKING": 0, "ARSPD_RATIO": 1.994, "RTL_ALT": 3000}


def test_mavproxy():
    text = "ACRO_BAL_PITCH   1.000000\nRTL_ALT\t1500 # in cm\nWPNAV_SPEED = 500\nMASK 0x1F\n"
    assert values(text) == {"ACRO_BAL_PITCH": 1.0, "RTL_ALT": 1500, "WPNAV_SPEED": 500, "MASK": 31}


def test_marks_of_ardupilot():
    file = parse_parameters("FRAME_CLASS 1 @READONLY # fixed\nFRAME_TYPE 0\n")
    assert [each.read_only for each in file.parameters] == [True, False]


def test_qgroundcontrol():
    text = (
        "# Onboard parameters for Vehicle 7\n#\n# Stack: PX4 Pro\n# Vehicle: Multi-Rotor\n# Version: 1.16.0\n"
        "#\n# Vehicle-Id Component-Id Name Value Type\n"
        "7\t1\tCOM_FLTMODE1\t-1\t6\n7\t1\tMPC_XY_P\t0.949999988079071045\t9\n7\t154\tCAM_MODE\t2\t1\n"
    )
    file = parse_parameters(text)
    assert (file.system, file.components) == (7, (1, 154))
    assert file.comments == ("Stack: PX4 Pro", "Vehicle: Multi-Rotor", "Version: 1.16.0")
    assert file.by_name() == {
        "COM_FLTMODE1": StoredParameter("COM_FLTMODE1", -1, KIND.INT32, 1),
        "MPC_XY_P": StoredParameter("MPC_XY_P", 0.949999988079071045, KIND.REAL32, 1),
    }
    assert list(file.by_name(154)) == ["CAM_MODE"]
    written = FORMATS["qgroundcontrol"].write(file)
    assert "7\t1\tMPC_XY_P\t0.95\t9\n" in written
    assert written.startswith("# Onboard parameters for Vehicle 7\n#\n# Stack: PX4 Pro\n")


def test_px4_script():
    text = "# an airframe\nparam set-default MC_ROLL_P 7\nparam set SYS_AUTOSTART 4001\n"
    assert values(text) == {"MC_ROLL_P": 7, "SYS_AUTOSTART": 4001}


def test_the_last_of_a_name_counts():
    assert parse_parameters("A 1\nB 2\nA 3\n").by_name()["A"].value == 3


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("A 1\nB x\n", "2: 'x' is not a number; correct or remove B"),
        ("A\n", "1: 'A' is not a name and a value"),
        ("A 1 2\n", "1: 'A 1 2' is not a name and a value"),
        ("@include other.parm\n", "1: @include is not supported; read the other file itself"),
        ("NAME_THAT_IS_TOO_LONG 1\n", "1: 'NAME_THAT_IS_TOO_LONG' cannot be a parameter's name"),
        ("1\t1\tA\t1\t6\n1\t1\tB\t1\n", "2: '1\\t1\\tB\\t1' does not have the columns"),
        ("1\t1\tA\t1\t11\n", "1: '11' is not a MAV_PARAM_TYPE, 1 to 10"),
        ("1\t1\tA\t300\t1\n", "1: A = 300 does not fit into UINT8"),
        ("1\t1\tA\t1.5\t6\n", "1: A = 1.5 does not fit into INT32"),
        ("256\t1\tA\t1\t6\n", "1: '256' is not a vehicle id, 0 to 255"),
        ("1\t1\tA\t1\t6\n2\t1\tB\t1\t6\n", "2: a second vehicle begins; split the file by its first column"),
        ("param set A 1\nif ver hwcmp X\n", "2: 'if ver hwcmp X' does not set a parameter"),
        ("", "it holds no parameters"),
        ("# nothing\n", "it holds no parameters"),
    ],
)
def test_errors_name_the_line(tmp_path, text, problem):
    from mavstack.files.parameters import read_parameters

    path = tmp_path / "bad.txt"
    path.write_text(text)
    with pytest.raises(ParameterFileError) as raised:
        read_parameters(path)
    separator = ":" if problem[0].isdigit() else ": "
    assert str(raised.value).startswith(f"{path}{separator}{problem}")
