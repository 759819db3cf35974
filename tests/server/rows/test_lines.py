from __future__ import annotations

from mavstack.server.rows.lines import MAX_LINE, LineAssembler


def test_lines_do_not_depend_on_how_the_stream_is_cut() -> None:
    data = "a,1\r\n\nb,2\nhalf é\n".encode()
    for size in (1, 2, 3, 100):
        lines = LineAssembler()
        found = [line for at in range(0, len(data), size) for line in lines.feed(data[at : at + size])]
        assert found == ["a,1", "b,2", "half é"]


def test_lines_that_are_too_long_are_dropped() -> None:
    lines = LineAssembler()
    assert lines.feed(b"x" * (MAX_LINE + 1)) == []
    assert lines.feed(b"x" * MAX_LINE * 3 + b"\ngood\n") == ["good"]
    assert lines.dropped == 1


def test_bytes_that_are_no_text() -> None:
    assert LineAssembler().feed(b"\xff,1\n") == ["\ufffd,1"]
