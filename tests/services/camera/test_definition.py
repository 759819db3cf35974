"""Camera definition files: settings, rules between them, and files that are not to be trusted."""

from __future__ import annotations

import lzma
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import DialectError, InvalidArgumentError, ParameterDenied
from mavstack.services.camera import CameraSettingsServer, read_definition
from mavstack.services.camera.definition_file import MAX_FILE_BYTES
from mavstack.services.extended_parameters import ExtendedParameterClient
from tests.services.camera.harness import CAMERA
from tests.services.network import GROUND, Network

KIND = common.MavParamExtType
FILE = b"""<?xml version="1.0" encoding="UTF-8" ?>
<mavlinkcamera>
  <definition version="3"><model>T1</model><vendor>Maker</vendor></definition>
  <parameters>
    <parameter name="CAM_MODE" type="uint32" default="0" control="0">
      <description>Mode</description>
      <options>
        <option name="Photo" value="0"><exclusions><exclude>CAM_VIDRES</exclude></exclusions></option>
        <option name="Video" value="1">
          <parameterranges>
            <parameterrange parameter="CAM_ISO" condition="CAM_EXPMODE=1">
              <roption name="100" value="100" /><roption name="200" value="200" />
            </parameterrange>
          </parameterranges>
        </option>
      </options>
    </parameter>
    <parameter name="CAM_EXPMODE" type="uint32" default="1">
      <updates><update>CAM_ISO</update></updates>
      <options>
        <option name="Auto" value="0"><exclusions><exclude>CAM_ISO</exclude></exclusions></option>
        <option name="Manual" value="1" />
      </options>
    </parameter>
    <parameter name="CAM_ISO" type="uint32" default="100">
      <options>
        <option name="100" value="100" /><option name="200" value="200" /><option name="800" value="800" />
      </options>
    </parameter>
    <parameter name="CAM_VIDRES" type="uint32" default="0">
      <options><option name="4K" value="0" /><option name="HD" value="1" /></options>
    </parameter>
    <parameter name="CAM_EV" type="float" default="0" min="-3" max="3" step="0.5" unit="EV" />
    <parameter name="CAM_IRLOCK" type="bool" default="0" />
    <parameter name="CAM_TAG" type="custom" default="none" />
    <parameter name="CAM_TEMP" type="float" default="20" readonly="1" />
  </parameters>
</mavlinkcamera>
"""


def test_a_file_is_read() -> None:
    definition = read_definition(FILE)
    assert (definition.vendor, definition.model, definition.version) == ("Maker", "T1", 3)
    mode = definition.settings["CAM_MODE"]
    assert (mode.type, mode.control, mode.text(1)) == (KIND.UINT32, False, "Video")
    exposure = definition.settings["CAM_EV"]
    assert (exposure.minimum, exposure.maximum, exposure.step) == (-3, 3, 0.5)
    assert exposure.text(0.5) == "0.5 EV"
    assert definition.settings["CAM_EXPMODE"].updates == ("CAM_ISO",)
    assert definition.settings["CAM_TAG"].default == "none"
    assert read_definition(lzma.compress(FILE)) == definition


def test_rules_between_settings() -> None:
    definition = read_definition(FILE)
    values = {"CAM_MODE": 0, "CAM_EXPMODE": 1, "CAM_ISO": 100}
    assert definition.excluded(values) == {"CAM_VIDRES"}
    assert list(definition.options_of("CAM_ISO", values)) == ["100", "200", "800"]
    values["CAM_MODE"] = 1
    assert definition.excluded(values) == set()
    assert list(definition.options_of("CAM_ISO", values)) == ["100", "200"]
    with pytest.raises(InvalidArgumentError, match="CAM_ISO cannot be 800; options: 100, 200"):
        definition.check("CAM_ISO", 800, values)
    values["CAM_EXPMODE"] = 0
    with pytest.raises(InvalidArgumentError, match="CAM_ISO has no effect with Auto"):
        definition.check("CAM_ISO", 100, values)
    with pytest.raises(InvalidArgumentError, match="no setting CAM_XX; its settings: CAM_MODE"):
        definition.check("CAM_XX", 100, values)


@pytest.mark.parametrize(
    ("name", "value", "problem"),
    [
        ("CAM_EV", 4.0, "it takes a number from -3 to 3"),
        ("CAM_EV", float("nan"), "cannot be nan"),
        ("CAM_IRLOCK", 2, "value on or off"),
        ("CAM_TEMP", 1.0, "can only be read"),
    ],
)
def test_values_that_a_setting_does_not_take(name: str, value: float, problem: str) -> None:
    with pytest.raises(InvalidArgumentError, match=problem):
        read_definition(FILE).check(name, value, {})


@pytest.mark.parametrize(
    ("name", "word", "value"),
    [
        ("CAM_MODE", "video", 1),
        ("CAM_ISO", "800", 800),
        ("CAM_IRLOCK", "on", 1),
        ("CAM_IRLOCK", "off", 0),
        ("CAM_EV", "-1.5", -1.5),
        ("CAM_TAG", "garden", "garden"),
        ("CAM_VIDRES", 1, 1),
    ],
)
def test_words_for_values(name: str, word: object, value: object) -> None:
    assert read_definition(FILE).settings[name].parse(word) == value


def test_a_word_that_is_no_value() -> None:
    with pytest.raises(InvalidArgumentError, match="'loud' is no option; options: Photo, Video"):
        read_definition(FILE).settings["CAM_MODE"].parse("loud")


@pytest.mark.parametrize(
    ("condition", "applies"),
    [
        ("", True),
        ("A=1", True),
        ("A!=1", False),
        ("A=1 AND B=2", True),
        ("A=1 AND B=3", False),
        ("A=0 OR B=2", True),
        ("B>1 AND B<3", True),
        ("C=1", False),
        ("nonsense", False),
    ],
)
def test_conditions(condition: str, applies: bool) -> None:
    text = FILE.replace(b"CAM_EXPMODE=1", condition.replace("<", "&lt;").encode())
    option = read_definition(text).settings["CAM_MODE"].options[1]
    assert option.ranges[0].applies({"A": 1, "B": 2.0}) is applies


ENTITY = b'<!DOCTYPE x [<!ENTITY a "aaaa">]><mavlinkcamera/>'
BOMB = lzma.compress(b" " * (MAX_FILE_BYTES + 10))


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (ENTITY, "entity declarations are not allowed"),
        (b"<other/>", "not a camera definition: the root is <other>"),
        (b"<mavlinkcamera>", "not well-formed"),
        (b"", "empty"),
        (BOMB, "larger than"),
        (lzma.compress(FILE)[:-20], "end too early"),
        (b"\xfd7zXZ\x00" + bytes(40), "damaged xz"),
        (FILE.replace(b'type="float"', b'type="colour"'), "unknown type 'colour'"),
        (FILE.replace(b'default="20"', b'default="warm"'), "'warm' is no value"),
        (FILE.replace(b'min="-3"', b'min="low"'), "min='low' is no number"),
        (FILE.replace(b"CAM_EV", b"CAM_ISO"), "CAM_ISO is defined twice"),
        (FILE.replace(b"CAM_EV", b"CAM_EXPOSURE_VALUE"), "name of 1 to 16 bytes"),
    ],
)
def test_files_that_are_refused(data: bytes, problem: str) -> None:
    with pytest.raises(DialectError, match=problem):
        read_definition(data, "camera.xml")


@given(st.binary(max_size=300), st.integers(0, len(FILE)))
def test_random_files_raise_one_error(junk: bytes, place: int) -> None:
    for data in (junk, FILE[:place] + junk + FILE[place:], lzma.compress(FILE)[: place // 4] + junk):
        with suppress(DialectError):
            read_definition(data)


def test_a_server_accepts_what_the_definition_allows() -> None:
    network = Network()
    camera = network.node(CAMERA)
    server = camera.engine.add(CameraSettingsServer(CAMERA, read_definition(FILE)))
    ground = network.node(GROUND)
    client = ground.engine.add(ExtendedParameterClient(GROUND, CAMERA))
    network.connect(ground, camera)

    def set_value(name: str, value: object):
        operation = client.set(name, value, network.now)
        ground.engine.touch(client)
        assert network.run(lambda: operation.done)
        return operation

    assert set_value("CAM_ISO", 800).result().value == 800
    assert isinstance(set_value("CAM_ISO", 5).error, ParameterDenied)
    assert isinstance(set_value("CAM_TEMP", 5.0).error, ParameterDenied)
    assert isinstance(set_value("CAM_VIDRES", 1).error, ParameterDenied)  # excluded in photo mode
    assert set_value("CAM_EV", 1.5).result().value == 1.5
    server.reset()
    assert server.values["CAM_ISO"] == 100
