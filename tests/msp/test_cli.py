from __future__ import annotations

import pytest

from mavstack import InvalidArgumentError
from mavstack.msp.cli import CliDialog, check_line, errors_in, is_leaving, restore_lines


def dialog(text: bytes, line: str = "diff") -> CliDialog:
    made = CliDialog()
    made.send(line)
    made.receive(text)
    return made


def test_a_reply_ends_with_the_echo_of_its_marker():
    made = CliDialog()
    assert made.send("diff") == b"diff\n# end 1\n"
    made.receive(b"\r\n# diff\r\n\r\n# version\r\n")
    assert made.reply() is None
    made.receive(b"\r\n# ")  # the end of a heading, or a prompt
    assert made.reply() is None
    made.receive(b"end\r\n\r\n# # en")
    assert made.reply() is None
    made.receive(b"d 1\r\n\r\n# ")
    assert made.reply() == "# version\n\n# end"
    assert made.reply() is None
    assert made.send("get a").endswith(b"# end 2\n")


@pytest.mark.parametrize(
    ("text", "reply"),
    [
        (b"diff\r\na = 1\r\n\r\n# # end 1", "a = 1"),
        (b"a = 1\r\n\r\n# # end 1", "a = 1"),  # no echo of the line
        (b"diff\r\nno diff\r\n\r\n# # end 1", "no diff"),
        (b"x diff\r\n\r\n# # end 1", "x diff"),
        (b"diff\r\n\r\n# # end 1", ""),
        (b"diff\r\n\xff\r\n\r\n# # end 1", "\ufffd"),
    ],
)
def test_replies_without_the_echo(text: bytes, reply: str):
    assert dialog(text).reply() == reply


def test_a_comment_and_an_empty_line():
    assert dialog(b"# end 1\r\n\r\n# ", "").reply() == ""
    assert dialog(b"# note\r\n\r\n# # end 1", "# note").reply() == ""


def test_the_prompt():
    made = CliDialog()
    made.receive(b"\r\nEntering CLI Mode\r\n\r\n#")
    assert not made.at_prompt
    made.receive(b" ")
    assert made.at_prompt
    assert made.text == "\nEntering CLI Mode\n\n# "


@pytest.mark.parametrize("line", ["a\tb", "get ?", "ü", "a\nb", "a" * 121])
def test_lines_that_the_cli_does_not_take(line: str):
    with pytest.raises(InvalidArgumentError, match="CLI line"):
        check_line(line)


@pytest.mark.parametrize(
    ("line", "leaving"),
    [
        ("save", True),
        ("EXIT", True),
        ("defaults", True),
        ("defaults nosave", False),
        ("save noreboot", False),
        ("# save", False),
        ("get save", False),
        ("", False),
    ],
)
def test_lines_that_restart_the_firmware(line: str, leaving: bool):
    assert is_leaving(line) is leaving
    assert dialog(b"", line).reply() is None


def test_errors_of_both_firmwares():
    assert errors_in("###ERROR IN set: INVALID NAME###\nok\n### ERROR: Invalid value\nInvalid name") == [
        "ERROR IN set: INVALID NAME",
        "ERROR: Invalid value",
        "Invalid name",
    ]
    assert errors_in("gyro_hardware set to AUTO\nno ERROR here") == []


def test_the_commands_of_a_dump():
    dump = "# version\n\nbatch start\ndefaults nosave\nset a = 1\n\n#set b = 2\nbatch end\nsave\nexit"
    assert restore_lines(dump) == [
        (3, "batch start"),
        (4, "defaults nosave"),
        (5, "set a = 1"),
        (8, "batch end"),
    ]
    with pytest.raises(InvalidArgumentError, match=r"^line 2: CLI line"):
        restore_lines("set a = 1\nset b = ?")
