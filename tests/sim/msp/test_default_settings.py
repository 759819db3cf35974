"""Files of default settings: enums by name, lists of records, bytes, and the codec of the firmware."""

from __future__ import annotations

import pytest

from mavstack.msp.messages.config import (
    Feature,
    FeatureConfig,
    InavFeature,
    InavSerialFunction,
    SerialConfig,
    SerialFunction,
)
from mavstack.msp.messages.rc import RxConfig
from mavstack.sim.msp.default_settings import read_defaults


@pytest.mark.parametrize(
    ("name", "variant", "features", "functions"),
    [
        ("betaflight_defaults.toml", "BTFL", Feature.GPS | Feature.TELEMETRY, SerialFunction),
        ("inav_defaults.toml", "INAV", InavFeature.GPS | InavFeature.TELEMETRY, InavSerialFunction),
    ],
)
def test_values_of_enums_are_those_of_the_firmware(
    name: str, variant: str, features: int, functions: type
) -> None:
    messages = {type(message): message for message in read_defaults(name, variant)}
    config, serial = messages[FeatureConfig], messages[SerialConfig]
    assert isinstance(config, FeatureConfig)
    assert config.features & features == features
    assert type(config.features) is type(features)
    assert isinstance(serial, SerialConfig)
    assert type(serial.ports[0].functions) is functions
    assert serial.ports[0].functions == SerialFunction.MSP


def test_bytes_are_hexadecimal() -> None:
    config = next(each for each in read_defaults("betaflight_defaults.toml") if isinstance(each, RxConfig))
    assert config.elrs_uid == bytes(6)
