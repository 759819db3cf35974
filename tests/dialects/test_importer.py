"""Importing official files: facts are kept, descriptions removed, and equal input gives equal bytes."""

from pathlib import Path

import pytest

import mavstack.dialects
from mavstack.dialects import importer
from mavstack.dialects.tables import official_names
from mavstack.dialects.xml_reader import read_bytes, read_tree

DEFINITIONS = Path(mavstack.dialects.__file__).parent / "definitions"

PUBLISHED = """<?xml version="1.0"?>
<mavlink>
  <!-- a remark -->
  <include>common.xml</include>
  <version>3</version>
  <dialect>4</dialect>
  <enums>
    <enum name="E" bitmask="true">
      <description>Enum prose.</description>
      <deprecated since="2020-01" replaced_by="F">Mark prose.</deprecated>
      <entry value="0x1" name="E_A" hasLocation="true" isDestination="false">
        <description>Entry prose.</description>
        <param index="1" label="Delay &amp; more" units="s" minValue="0" maxValue="1.5" increment="1">
          Param prose.
        </param>
        <param index="2" reserved="true" default="NaN"/>
        <param index="3">Empty prose</param>
      </entry>
      <entry value="2**1" name="E_B"><wip/><description>More prose.</description></entry>
    </enum>
  </enums>
  <messages>
    <message id="9000" name="ONE">
      <superseded since="2021-02" replaced_by="TWO"><description>Old prose.</description></superseded>
      <description>Message prose.</description>
      <field type="uint8_t_mavlink_version" name="v">Field prose.</field>
      <field type="float[3]" name="f" units="m/s" invalid="[NaN]" multiplier="1E-2" print_format="0x%04x">
      F.</field>
      <extensions/>
      <field type="uint8_t" name="e" enum="E" display="bitmask" instance="true" minValue="1" default="0">
      E.</field>
    </message>
    <message id="9001" name="TWO">
      <description>Prose two.</description>
      <field type="char[9]" name="t">T.</field>
    </message>
  </messages>
</mavlink>
"""

OURS = """<mavlink>
  <include>common.xml</include>
  <version>3</version>
  <dialect>4</dialect>
  <enums>
    <enum name="E" bitmask="true">
      <deprecated since="2020-01" replaced_by="F"/>
      <entry value="1" name="E_A" hasLocation="true">
        <param index="1" label="Delay &amp; more" units="s" increment="1" minValue="0" maxValue="1.5"/>
        <param index="2" reserved="true" default="NaN"/>
        <param index="3"/>
      </entry>
      <entry value="2" name="E_B">
        <wip/>
      </entry>
    </enum>
  </enums>
  <messages>
    <message id="9000" name="ONE">
      <superseded since="2021-02" replaced_by="TWO"/>
      <description>Our own line &lt;1&gt;.</description>
      <field type="uint8_t_mavlink_version" name="v"/>
      <field type="float[3]" name="f" print_format="0x%04x" units="m/s" multiplier="1E-2" invalid="[NaN]"/>
      <extensions/>
      <field type="uint8_t" name="e" enum="E" display="bitmask" minValue="1" default="0" instance="true"/>
    </message>
    <message id="9001" name="TWO">
      <field type="char[9]" name="t"/>
    </message>
  </messages>
</mavlink>
"""


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "published.xml"
    path.write_text(PUBLISHED)
    return path


def test_facts_are_kept_and_descriptions_removed(source, tmp_path):
    target = tmp_path / "ours.xml"
    importer.import_file(str(source), str(target), {"ONE": "Our own line <1>."})
    assert target.read_text().partition("-->\n")[2] == OURS


def test_importing_again_keeps_our_descriptions_and_every_byte(source, tmp_path):
    target = tmp_path / "ours.xml"
    importer.import_file(str(source), str(target), {"ONE": "Our own line <1>."})
    first = target.read_bytes()
    importer.import_file(str(source), str(target))
    assert target.read_bytes() == first
    importer.import_file(str(target), str(tmp_path / "again.xml"), importer.descriptions_in(str(target)))
    assert (tmp_path / "again.xml").read_bytes() == first


def test_a_given_description_replaces_the_present_one(source, tmp_path):
    target = tmp_path / "ours.xml"
    importer.import_file(str(source), str(target), {"ONE": "Old."})
    importer.import_file(str(source), str(target), {"ONE": "New."})
    assert importer.descriptions_in(str(target)) == {"ONE": "New."}


@pytest.mark.parametrize("name", official_names())
def test_our_files_equal_the_output_of_the_importer(name, tmp_path):
    ours = DEFINITIONS / f"{name}.xml"
    target = tmp_path / "again.xml"
    importer.import_file(str(ours), str(target), importer.descriptions_in(str(ours)))
    assert target.read_bytes() == ours.read_bytes()


@pytest.mark.parametrize("name", official_names())
def test_our_files_have_one_line_of_description_per_message(name):
    path = str(DEFINITIONS / f"{name}.xml")

    def walk(element, above):
        allowed = element.tag in ("include", "version", "dialect") or (element.tag, above) == (
            "description",
            "message",
        )
        assert allowed or not element.text, (element.tag, element.line)
        assert "\n" not in element.text
        for child in element.children:
            walk(child, element.tag)

    walk(read_tree(read_bytes(path), path), "")


@pytest.mark.parametrize("name", ["minimal", "standard", "common", "ardupilotmega"])
def test_every_message_of_the_main_dialects_has_a_description(name):
    definition = importer.read_file(str(DEFINITIONS / f"{name}.xml"))
    for message in definition.messages:
        assert 10 <= len(message.description) <= 160, message.name
        assert message.description.endswith("."), message.name
