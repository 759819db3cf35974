from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.gnss.ublox import FixedPosition, SurveyIn, UbxFramer, base_configuration


def values(data: bytes) -> dict[str, int]:
    from pyubx2 import SET, UBXReader

    message = UBXReader.parse(data, msgmode=SET)
    return {name: value for name, value in vars(message).items() if name.startswith("CFG_")}


def survey(duration: int, accuracy: int, valid: int) -> bytes:
    from pyubx2 import GET, UBXMessage

    message = UBXMessage(
        "NAV", "NAV-SVIN", GET, dur=duration, meanAcc=accuracy, valid=valid, active=1 - valid
    )
    data: bytes = message.serialize()
    return data


def test_a_survey_is_configured():
    found = values(base_configuration(SurveyIn(120, 1.5)))
    assert (found["CFG_TMODE_MODE"], found["CFG_TMODE_SVIN_MIN_DUR"]) == (1, 120)
    assert found["CFG_TMODE_SVIN_ACC_LIMIT"] == 15_000
    assert found["CFG_MSGOUT_RTCM_3X_TYPE1074_USB"] == 1
    assert found["CFG_MSGOUT_RTCM_3X_TYPE1005_UART1"] == 5


@given(st.floats(-90, 90), st.floats(-180, 180), st.floats(-1000, 20_000))
def test_a_fixed_position_keeps_its_digits(latitude, longitude, height):
    found = values(base_configuration(FixedPosition(latitude, longitude, height)))
    assert found["CFG_TMODE_LAT"] * 100 + found["CFG_TMODE_LAT_HP"] == round(latitude * 1e9)
    assert found["CFG_TMODE_LON"] * 100 + found["CFG_TMODE_LON_HP"] == round(longitude * 1e9)
    assert found["CFG_TMODE_HEIGHT"] * 100 + found["CFG_TMODE_HEIGHT_HP"] == round(height * 1e4)


@pytest.mark.parametrize("mode", [SurveyIn(0, 1), SurveyIn(60, 0), FixedPosition(91, 0, 0)])
def test_wrong_values_are_refused(mode):
    with pytest.raises(InvalidArgumentError):
        base_configuration(mode)


@given(st.binary(max_size=30).filter(lambda data: 0xB5 not in data))
def test_the_progress_of_a_survey_is_found(junk):
    framer = UbxFramer()
    data = junk + survey(30, 21_000, 0) + b"\xd3\x00" + survey(61, 12_000, 1)
    states = [state for byte in data for state in framer.feed(bytes([byte]))]
    assert [(state.duration, state.accuracy, state.is_valid) for state in states] == [
        (30, 2.1, False),
        (61, 1.2, True),
    ]


@given(st.lists(st.binary(max_size=200)))
def test_any_bytes_are_accepted(chunks):
    framer = UbxFramer()
    for chunk in chunks:
        framer.feed(chunk)
