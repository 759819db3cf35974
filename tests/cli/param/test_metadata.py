"""`mav param get -v`, and the checks of `mav param set`, against simulated vehicles."""

from __future__ import annotations

import json

import pytest

from tests.cli.harness import COPTER, PX4_COPTER

APM_XML = """\
<?xml version="1.0" encoding="utf-8"?>
<paramfile>
  <vehicles>
    <parameters name="ArduCopter">
      <param humanName="Way home" name="ArduCopter:RTL_ALT" documentation="As high as a tree.">
        <field name="Units">cm</field>
        <field name="Range">200 5000</field>
        <field name="RebootRequired">True</field>
      </param>
    </parameters>
  </vehicles>
</paramfile>
"""


@pytest.fixture
def px4(simulate):
    return simulate(PX4_COPTER)


def test_get_describes_a_parameter_of_px4(mav, px4):
    result = mav("param", "get", "-v", "RTL_RETURN_ALT", "NAV_DLL_ACT", "COM_RCL_EXCEPT")
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        "RTL_RETURN_ALT  30 m  real32\n"
        "    Height above home at which the vehicle returns; it climbs first if it is lower\n"
        "    range at least 0 m, default 30\n"
        "NAV_DLL_ACT  0  int32\n"
        "    Reaction to a lost ground station\n"
        "    default 0\n"
        "    * 0: None\n"
        "      1: Hold\n"
        "      2: Return\n"
        "      3: Land\n"
        "      5: Terminate\n"
        "      6: Disarm\n"
        "COM_RCL_EXCEPT  0  int32\n"
        "    Modes in which lost manual control is ignored\n"
        "    range 0 to 31, default 0\n"
        "      bit 0 (1): Mission\n"
        "      bit 1 (2): Hold\n"
        "      bit 2 (4): Offboard\n"
        "      bit 3 (8): External modes\n"
        "      bit 4 (16): Altitude cruise\n"
    )


def test_get_describes_in_another_language(mav, px4, caplog):
    result = mav("param", "get", "-v", "RTL_RETURN_ALT", "--locale", "de_DE")
    assert "    Mindesthöhe der Rückkehr über dem Startplatz.\n" in result.out
    result = mav("param", "get", "-v", "RTL_RETURN_ALT", "--locale", "fr_FR")
    assert "    Height above home at which the vehicle returns" in result.out
    assert "is not translated: it has no translation to fr_FR" in caplog.text


def test_get_describes_as_json(mav, px4):
    [printed] = json.loads(mav("param", "get", "--describe", "SYS_AUTOSTART", "--json").out)
    assert (printed["name"], printed["value"]) == ("SYS_AUTOSTART", 10040)
    assert printed["metadata"]["reboot_required"] is True
    assert (printed["metadata"]["minimum"], printed["metadata"]["maximum"]) == (0, 9999999)


def test_get_without_description(mav, simulate):
    harness = simulate(COPTER)
    harness.vehicle.messages._streams.pop(397)  # as a real ArduPilot, which serves none
    result = mav("param", "get", "-v", "RTL_ALT")
    assert (result.code, result.out) == (0, "RTL_ALT  1500  int32\n    no description\n")
    assert result.err == (
        "mav param: vehicle 1: downloading metadata from 1/1 failed: it has none "
        "(COMPONENT_METADATA: DENIED); --metadata FILE takes descriptions from a file\n"
    )


def test_a_file_describes_and_is_remembered(mav, simulate, tmp_path):
    harness = simulate(COPTER)
    harness.vehicle.messages._streams.pop(397)
    file = tmp_path / "apm.pdef.xml"
    file.write_text(APM_XML)
    described = (
        "RTL_ALT  1500 cm  int32\n    Way home\n    As high as a tree.\n"
        "    range 200 to 5000 cm, takes effect after a reboot\n"
    )
    assert mav("param", "get", "-v", "RTL_ALT", "--metadata", file).out == described
    file.unlink()
    assert mav("param", "get", "-v", "RTL_ALT").out == described
    assert "outside of its range 200 to 5000 cm" in mav("param", "set", "RTL_ALT", "20").err
    assert (
        mav("param", "set", "RTL_ALT", "2000").out
        == "vehicle 1: RTL_ALT: 1500 -> 2000; takes effect after a reboot\n"
    )


def test_values_are_listed_by_number(mav, simulate, tmp_path):
    """ArduPilot's own JSON file lists them as texts: 0, 1, 10, 2."""
    simulate(COPTER)
    names = {"10": "Ten", "2": "Two", "3": "Three"}
    file = tmp_path / "apm.pdef.json"
    file.write_text(json.dumps({"FRAME": {"FRAME_CLASS": {"DisplayName": "Frame", "Values": names}}}))
    lines = mav("param", "get", "-v", "FRAME_CLASS", "--metadata", file).out.splitlines()
    assert [line.split()[-1] for line in lines if ": " in line] == ["Two", "Three", "Ten"]


def test_a_file_that_is_none(mav, simulate, tmp_path):
    simulate(COPTER)
    file = tmp_path / "notes.xml"
    file.write_text("<notes/>")
    result = mav("param", "get", "-v", "RTL_ALT", "--metadata", file)
    assert result.code == 1
    assert result.err == f"mav param: {file}: <notes> is not the root of a file of parameter metadata\n"
    assert "No such file" in mav("param", "get", "-v", "RTL_ALT", "--metadata", tmp_path / "none.xml").err


def test_set_refuses_what_the_metadata_does_not_allow(mav, px4):
    result = mav("param", "set", "MPC_XY_CRUISE=50", "NAV_DLL_ACT=4", "COM_RCL_EXCEPT=33", "MPC_XY_CRUISE=7")
    assert result.code == 1
    assert result.out == "vehicle 1: MPC_XY_CRUISE: 5 -> 7\n"
    result = mav("param", "set", "MPC_XY_CRUISE=50", "NAV_DLL_ACT=4", "COM_RCL_EXCEPT=33", "NAV_RCL_ACT=3")
    assert (result.code, result.out) == (1, "vehicle 1: NAV_RCL_ACT: 2 -> 3\n")
    problems = {
        "MPC_XY_CRUISE to 50": "50 is outside of its range 3 to 20 m/s",
        "NAV_DLL_ACT to 4": "4 is not one of its values "
        "0 (None), 1 (Hold), 2 (Return), 3 (Land), 5 (Terminate), 6 (Disarm)",
        "COM_RCL_EXCEPT to 33": "33 sets bit 5, which is not one of its bits 0, 1, 2, 3, 4",
    }
    assert result.err.splitlines() == [
        f"mav param: vehicle 1: setting parameter {what} on 1/1 failed: {problem}; --force sends it anyway"
        for what, problem in problems.items()
    ]
    assert mav("param", "set", "MPC_XY_CRUISE", "50", "--force").out == "vehicle 1: MPC_XY_CRUISE: 7 -> 50\n"


def test_metadata_is_downloaded_once(mav, px4):
    opened: list[str] = []
    open_file = px4.vehicle.storage.files.open_file

    def counted(path: str, **options):
        opened.append(path)
        return open_file(path, **options)

    px4.vehicle.storage.files.open_file = counted
    mav("param", "get", "-v", "MPC_XY_CRUISE")
    assert {path.rpartition("/")[2] for path in opened} == {"component_general.json.xz", "parameters.json.xz"}
    opened.clear()
    assert "Horizontal speed" in mav("param", "get", "-v", "MPC_XY_CRUISE").out
    assert opened == []
