from __future__ import annotations

import pickle

import pytest

from mavstack.errors import InvalidArgumentError, InvalidTypeError, MspDecodeError
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.motors import MotorConfig, SetMotorConfig
from mavstack.msp.messages.rc import RcTuning, SetRawRc, SetRcTuning
from mavstack.msp.messages.sensors import Altitude, Attitude

INAV = FirmwareInfo("INAV", api=(2, 5))


def test_scaled_fields() -> None:
    attitude = Attitude.decode(bytes.fromhex("7b00 85ff 0e01"))
    assert attitude == Attitude(roll=12.3, pitch=-12.3, heading=270)
    assert attitude.encode() == bytes.fromhex("7b00 85ff 0e01")
    assert (Attitude.COMMAND, Attitude.NAME) == (108, "MSP_ATTITUDE")
    assert pickle.loads(pickle.dumps(attitude)) == attitude


def test_fields_of_one_firmware() -> None:
    payload = bytes.fromhex("e8030000 9cff d2040000")
    assert Altitude.decode(payload) == Altitude(10.0, -1.0)
    assert Altitude.decode(payload, INAV) == Altitude(10.0, -1.0, 12.34)
    assert Altitude(10.0, -1.0, 12.34).encode(INAV) == payload
    assert Altitude(10.0, -1.0, 12.34).encode() == payload[:6]


def test_fields_that_an_old_firmware_does_not_send_are_none() -> None:
    tuning = RcTuning.decode(bytes(range(14)))
    assert (tuning.pitch_expo, tuning.rates_type) == (13, None)
    assert tuning.encode() == bytes(range(14))


def test_bytes_of_a_newer_firmware_are_ignored() -> None:
    assert Attitude.decode(bytes(10)) == Attitude(0.0, 0.0, 0)


def test_fields_that_an_old_firmware_does_not_know_are_left_out() -> None:
    tuning = RcTuning.decode(bytes(range(24)))
    assert len(tuning.encode()) == 24
    assert len(tuning.encode(FirmwareInfo("BTFL", api=(1, 42)))) == 22
    assert len(tuning.encode(INAV)) == 11


def test_a_payload_that_ends_in_a_field_is_refused() -> None:
    with pytest.raises(MspDecodeError) as refused:
        Attitude.decode(bytes(5))
    assert (
        str(refused.value)
        == "decoding MSP_ATTITUDE failed: payload of 5 bytes ends in heading, 1 more are needed"
    )


@pytest.mark.parametrize(
    ("message", "error", "text"),
    [
        (
            Attitude(4000.0, 0.0, 0),
            InvalidArgumentError,
            "roll must be between -3276.8 and 3276.7, got 4000.0",
        ),
        (Attitude(float("nan"), 0.0, 0), InvalidArgumentError, "roll must be between"),
        (Attitude(0.0, 0.0, "north"), InvalidTypeError, "heading must be a number, got 'north'"),
        (SetRawRc(1500), InvalidTypeError, "channels must be a sequence, got 1500"),
        (SetRawRc((1500, 70000)), InvalidArgumentError, "channels must be between 0 and 65535, got 70000"),
        (MotorConfig(0, 0, 0, None, 14), InvalidArgumentError, "motor_count must be set, because pole_count"),
    ],
)
def test_values_that_do_not_fit_are_refused(message: Attitude, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=f"^encoding {message.NAME} failed: {text}"):
        message.encode()


def test_a_request_from_the_reply_that_it_changes() -> None:
    config = MotorConfig(
        0, 2000, 1000, motor_count=4, pole_count=14, use_dshot_telemetry=True, use_esc_sensor=False
    )
    changed = SetMotorConfig.from_message(config, max_throttle=1900)
    assert changed == SetMotorConfig(0, 1900, 1000, 14, use_dshot_telemetry=True)
    with pytest.raises(InvalidArgumentError, match="MSP_SET_RC_TUNING has no field mass"):
        SetRcTuning.from_message(RcTuning.decode(bytes(24)), mass=1)
