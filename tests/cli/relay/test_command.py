"""`mav relay`: the server as a process, and the URLs of an invitation."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import contextmanager

import pytest

from mavstack.cli.main import main
from mavstack.links import open_link
from mavstack.links.url import parse_url


@pytest.fixture
def key(tmp_path) -> str:
    path = tmp_path / "relay.key"
    path.write_text("a key of tickets\n")
    return str(path)


def mav(capsys, *words, code=0):
    assert main(list(words)) == code, capsys.readouterr().err
    return capsys.readouterr()


@contextmanager
def serving(key):
    words = [sys.executable, "-m", "mavstack", "relay", "serve", "--tickets", key, "--port", "0", "--json"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process, json.loads(process.stdout.readline())
        finally:
            process.terminate()


async def test_a_vehicle_and_a_ground_station_meet_by_an_invitation(capsys, key):
    with serving(key) as (process, address):
        found = json.loads(
            mav(capsys, "relay", "invite", "boat", address["url"], "--tickets", key, "--json").out
        )
        async with open_link(found["host"]) as host, open_link(found["guest"]) as guest:
            channel = (await anext(guest)).channel
            channel.write(b"hello")
            await anext(host)
            assert (await anext(host)).data == b"hello"
        process.terminate()
        counts = json.loads(process.stdout.readline())["counts"]
        assert process.wait() == 143
    assert counts["came"] == 2


def test_the_urls_of_an_invitation(capsys, key):
    found = mav(capsys, "relay", "invite", "boat", "wss://relay.example/meet", "--tickets", key)
    host, guest = (parse_url(line) for line in found.out.split() if "://" in line)
    assert (host.scheme, guest.scheme) == ("relayin", "relay")
    assert (host.host, host.port, host.path) == ("relay.example", 443, "/meet")
    assert host.options["secret"] == guest.options["secret"] != ""
    assert "tls" not in host.options
    assert "keep it secret" in found.err


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("invite", "Boat", "wss://relay.example"), "room must be"),
        (("invite", "boat", "http://relay.example"), "not the URL of a relay"),
        (("invite", "boat", "wss://relay.example:x"), "not the URL of a relay"),
        (("invite", "boat", "wss://relay.example", "--days", "0"), "--days must be"),
        (("serve", "--port", "70000"), "--port must be"),
        (("serve", "--pace", "0"), "at least 1"),
        (("serve", "--certificate-key", "key.pem"), "needs --certificate"),
    ],
)
def test_wrong_usage(capsys, key, words, reason):
    assert reason in mav(capsys, "relay", *words, "--tickets", key, code=2).err


def test_a_url_is_revoked(capsys, key, tmp_path):
    path = str(tmp_path / "revoked.txt")
    words = ("relay", "invite", "boat", "wss://relay.example", "--tickets", key, "--json")
    url = json.loads(mav(capsys, *words).out)["guest"]
    assert mav(capsys, "relay", "revoke", url, "--list", path).out == "revoked\n"
    ticket = parse_url(url).options["ticket"]
    assert mav(capsys, "relay", "revoke", ticket, "--list", path).out == "it was revoked before\n"
    assert "not a ticket" in mav(capsys, "relay", "revoke", "wss://x?ticket=1", "--list", path, code=2).err


def test_a_key_that_is_missing_is_named(capsys):
    assert "none" in mav(capsys, "relay", "serve", "--tickets", "none", code=1).err
