"""Facts in DataFlash logs: firmware, hardware, parameters, texts and modes."""

from __future__ import annotations

from mavstack.logs import open_log

from .writer import TYPES, LogWriter


def opened(tmp_path, writer):
    path = tmp_path / "log.BIN"
    path.write_bytes(bytes(writer.data))
    return open_log(path)


def test_firmware_and_hardware_are_in_the_texts(tmp_path):
    writer = LogWriter()
    for text in ("ArduPlane V4.5.7 (2a3dc4b7)", "ChibiOS: 6a85082c", "CubeOrangePlus 0025003A 32385107"):
        writer.write("MSG", 1000, text)
    writer.write("PARM", 1000, "SYSID_THISMAV", 12.0, 1.0)
    log = opened(tmp_path, writer)
    assert log.info == {
        "autopilot": "ArduPilot",
        "vehicle_type": "FIXED_WING",
        "firmware": "ArduPlane",
        "firmware_version": "4.5.7",
        "firmware_git": "2a3dc4b7",
        "hardware": "CubeOrangePlus 0025003A 32385107",
        "system": "12",
    }
    assert log.vehicles[12].vehicle_type == "FIXED_WING"


def test_ver_names_the_version_exactly(tmp_path):
    types = (*TYPES, (20, "VER", "QBHBBBBI", "TimeUS,BT,BST,Maj,Min,Pat,FWT,GH", "s-------", "F-------"))
    writer = LogWriter(types)
    writer.write("VER", 1000, 3, 0, 4, 6, 1, 255, 0x0A1B2C3D)
    info = opened(tmp_path, writer).info
    assert (info["firmware_version"], info["firmware_git"]) == ("4.6.1", "0a1b2c3d")


def test_parameters_have_first_values_and_changes(tmp_path):
    writer = LogWriter()
    for time, name, value in (
        (1, "RTL_ALT", 1500.0),
        (2, "WPNAV_SPEED", 500.0),
        (3, "RTL_ALT", 1500.0),
        (4, "RTL_ALT", 3000.0),
    ):
        writer.write("PARM", time, name, value, float("nan"))
    log = opened(tmp_path, writer)
    assert log.parameters == {"RTL_ALT": 1500.0, "WPNAV_SPEED": 500.0}
    (change,) = log.parameter_changes
    assert (change.name, change.before, change.value, change.boot_us) == ("RTL_ALT", 1500.0, 3000.0, 4)


def test_texts_have_times_and_long_ones_are_joined(tmp_path):
    types = [kind for kind in TYPES if kind[1] != "MSG"]
    writer = LogWriter([*types, (5, "MSG", "QBBZ", "TimeUS,ID,Seq,Message", "s---", "F---")])
    for number, sequence, text in ((1, 0, "x" * 64), (1, 1, "yz"), (2, 0, "short")):
        writer.write("MSG", 5_000_000, number, sequence, text)
    texts = opened(tmp_path, writer).texts
    assert [text.text for text in texts] == ["x" * 64 + "yz", "short"]
    assert (texts[0].severity, texts[0].boot_us) == (6, 5_000_000)


def test_modes_have_names_of_the_firmware(tmp_path):
    for firmware, name in (("ArduCopter V4.5.7", "LOITER"), ("ArduPlane V4.5.7", "FLY_BY_WIRE_A")):
        writer = LogWriter()
        writer.write("MSG", 1, firmware)
        writer.write("MODE", 2, 5, 5, 1)
        table = opened(tmp_path, writer)["MODE"]
        assert name in table.enum_names("ModeNum")[0]


def test_a_log_without_texts_and_parameters_has_no_facts(tmp_path):
    log = opened(tmp_path, LogWriter())
    assert (log.texts, log.parameters, log.parameter_changes) == ([], {}, [])
    assert log.info == {"autopilot": "ArduPilot"}
