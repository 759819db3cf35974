from __future__ import annotations

from mavstack.sim.msp.command_line import MAX_LINE, CommandLine


def command_line() -> CommandLine:
    return CommandLine({"say": lambda text: f"{text}\n", "exit": lambda _: "bye"})


def test_keys_are_echoed_and_lines_answered():
    line = command_line()
    assert line.feed(b"say hallo") == b"say hallo"
    assert line.feed(b"\r\n") == b"\r\nhallo\r\n\r\n# "


def test_backspace_comments_and_blanks():
    line = command_line()
    assert line.feed(b"  sax\x7fy a # comment\n").endswith(b"\r\na\r\n\r\n# ")
    assert line.feed(b"\n\n") == b""


def test_an_unknown_command():
    assert b"###ERROR IN input: UNKNOWN COMMAND, TRY 'HELP'###" in command_line().feed(b"nonsense\n")


def test_exit_and_the_end_of_the_input_end_it():
    for typed in (b"exit\n", b"\x04"):
        line = command_line()
        assert line.feed(typed + b"say more\n").endswith(b"bye")
        assert line.closed


def test_a_line_is_bounded():
    assert len(command_line().feed(b"x" * 10_000)) == MAX_LINE
