from __future__ import annotations

import asyncio
import contextlib
import json
from argparse import ArgumentParser
from urllib.request import urlopen

import pytest

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.web import command


def parse(*words: str):
    parser = ArgumentParser()
    command.add_arguments(parser)
    return parser.parse_args([*words, "--no-browser"])


async def test_it_serves_the_api_until_it_is_cancelled(monkeypatch) -> None:
    printed: asyncio.Queue[dict[str, str]] = asyncio.Queue()
    monkeypatch.setattr(command, "echo_json", printed.put_nowait)
    rows = "csv+tcpin://127.0.0.1:0?name=cansat&template=time:s,alt:m"
    arguments = parse("udpin://127.0.0.1:0", rows, "--port", "0", "--json")
    serving = asyncio.create_task(command._serve(arguments))
    async with asyncio.timeout(20):
        url = (await printed.get())["url"]

        def ask() -> object:
            with urlopen(f"{url}api/sources", timeout=10) as answer:
                return json.loads(answer.read())

        packets, lines = await asyncio.to_thread(ask)
    assert packets["state"] == lines["state"] == "waiting"  # type: ignore[has-type]
    assert lines["rows"]["name"] == "cansat"  # type: ignore[has-type]
    serving.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await serving


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--port", "70000"), "--port must be from 0 to 65535"),
        (("--certificate-key", "x.pem"), "needs --certificate"),
        (("--host", "0.0.0.0"), "give --password or --tickets too"),
    ],
)
def test_wrong_usage(words, problem) -> None:
    with pytest.raises(UsageError, match=problem):
        command.run(parse(*words))


def test_a_short_password_is_an_error(tmp_path) -> None:
    path = tmp_path / "password"
    path.write_text("short")
    with pytest.raises(CommandError, match="8 characters"):
        command.run(parse("--host", "0.0.0.0", "--password", str(path)))


def test_the_start_reports_where_the_station_is(capsys, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(command, "gethostname", lambda: "field")
    monkeypatch.setattr("mavstack.server.app.STATIC", tmp_path)
    command._announce(parse("--host", "0.0.0.0"), 8080, secure=False)
    shown = capsys.readouterr()
    assert shown.out.splitlines() == [
        "ground station on http://localhost:8080/; Ctrl-C to end",
        "other machines: http://field:8080/, with a password or a ticket",
    ]
    assert "not built: run `make station`" in shown.err
    assert "clear text" in shown.err
    (tmp_path / "index.html").touch()
    command._announce(parse("--host", "::1"), 8443, secure=True)
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("ground station on https://[::1]:8443/; Ctrl-C to end\n", "")
