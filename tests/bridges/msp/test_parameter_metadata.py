"""The texts, units and ranges of the settings, as ground stations download them."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import FileDenied
from mavstack.msp.settings import Settings
from mavstack.services.parameters import ParameterMetadata
from tests.bridges.msp.fake_controller import run


def test_they_are_downloaded_with_names_and_aliases():
    async def scenario(vehicle, controller, bridge):
        found = await vehicle.params.download_metadata(cache=None)
        assert set(found) == set(await vehicle.params.download())
        assert found["BF_RATE_RC_EXPO"] == ParameterMetadata(
            name="BF_RATE_RC_EXPO",
            short_description="A gain",
            unit="%",
            minimum=0,
            maximum=200,
            increment=0.01,
            decimal_places=2,
            group="RATE",
            type=found["BF_RATE_RC_EXPO"].type,
        )
        assert found["MSP_HAS_OSD"].read_only
        assert found.problem("BF_PID_ROLL_P", 201) is not None

    run(scenario)


def test_another_firmware_has_other_texts():
    async def scenario(vehicle, controller, bridge):
        before = await vehicle.component.request_message(common.ComponentMetadata)
        definitions = Settings(controller.info).definitions
        controller.settings._definitions = definitions
        after = await vehicle.component.request_message(common.ComponentMetadata)
        assert after.uri == before.uri
        assert after.file_crc != before.file_crc
        found = await vehicle.params.download_metadata(cache=None)
        assert len(found) > len(definitions) > 200
        for each in definitions:
            assert found[each.name].short_description == each.description
            assert found[each.name].values == each.values

    run(scenario)


def test_the_file_is_read_only():
    async def scenario(vehicle, controller, bridge):
        with pytest.raises(FileDenied):
            await vehicle.component.ftp.upload("notes.txt", b"text")

    run(scenario)
