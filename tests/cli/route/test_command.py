from __future__ import annotations

import asyncio
import json
import os
import signal

import pytest

from mavstack.cli.registry import command_parser
from mavstack.cli.route import running
from mavstack.router.config import SigningConfig, parse_config
from mavstack.router.control.client import ControlClient
from mavstack.security import SigningKey
from tests.router.peers import UdpPeer, heartbeat, until

UDP, TCP = "udpin://127.0.0.1:0", "tcpin://127.0.0.1:0"
CONFIG = f'[endpoint.ground]\nurl = "{UDP}"\n'


@pytest.fixture
def ending(monkeypatch):
    """End each router of the command line by a signal, after what the test does with it."""
    show = running._show
    chosen = {"signal": signal.SIGTERM, "before": None}

    def show_and_end(router, arguments, tasks, stack):
        show(router, arguments, tasks, stack)

        async def end():
            await asyncio.sleep(0)  # until the signal handlers are set
            if chosen["before"] is not None:
                await chosen["before"](router)  # type: ignore[operator]
            os.kill(os.getpid(), chosen["signal"])

        tasks.start(end())

    monkeypatch.setattr(running, "_show", show_and_end)
    return chosen


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_runs_until_a_signal(mav, ending, number):
    ending["signal"] = number
    result = mav("route", "-e", UDP, "-e", TCP, "-e", UDP)
    assert (result.code, result.err) == (0, "")
    lines = result.out.splitlines()
    assert [line.split(" on ")[0] for line in lines] == ["udpin: open", "tcpin: listening", "udpin2: open"]


def test_an_endpoint_that_cannot_be_opened_ends_the_command(mav):
    with UdpPeer() as other:
        result = mav("route", "-e", UDP, "-e", f"udpin://127.0.0.1:{other.port}")
    assert result.code == 1
    assert len(result.err.splitlines()) == 1
    assert "mav route: endpoint udpin2: cannot open" in result.err
    assert "is in use by another program" in result.err


def test_json_is_one_object_with_the_state(mav, ending):
    result = mav("route", "-e", UDP, "--json")
    state = json.loads(result.out.splitlines()[0])
    (endpoint,) = state["endpoints"]
    assert (endpoint["name"], endpoint["state"]) == ("udpin", "open")
    assert (state["routes"], state["alerts"]) == ([], [])


def test_a_recorder_of_the_command_line(mav, ending, tmp_path):
    path = tmp_path / "flight.tlog"

    async def send(router):
        with UdpPeer(router.endpoints["udpin"].address[1]) as peer:
            peer.send(heartbeat())
            await until(lambda: path.exists() and path.stat().st_size)

    ending["before"] = send
    assert mav("route", "-e", UDP, "--record", str(path)).code == 0
    assert path.stat().st_size == len(heartbeat()) + 8


def test_sighup_loads_the_file_again(mav, ending, tmp_path):
    path = tmp_path / "router.toml"
    path.write_text(CONFIG)

    async def change(router):
        path.write_text(CONFIG + f'[endpoint.other]\nurl = "{UDP}"\n')
        os.kill(os.getpid(), signal.SIGHUP)
        await until(lambda: "other" in router.endpoints)

    ending["before"] = change
    assert mav("route", str(path)).code == 0


def test_ctl_controls_a_running_router(mav, ending, tmp_path, capsys):
    path = tmp_path / "router.toml"
    path.write_text(CONFIG)
    done = []

    async def control(router):
        address = capsys.readouterr().err.split("http://")[1].split()[0]
        client = ControlClient(address)
        await asyncio.to_thread(client.add, "tablet", {"url": UDP})
        await asyncio.to_thread(client.reload)
        assert [each["name"] for each in await asyncio.to_thread(client.endpoints)] == ["ground"]
        done.append(True)

    ending["before"] = control
    assert mav("route", str(path), "--control", "127.0.0.1:0").code == 0
    assert done


class FakeClient:
    """A client of the control API that keeps its calls."""

    def __init__(self, address, token=""):
        self.address, self.token = address, token
        self.calls = []
        FakeClient.last = self

    def __getattr__(self, name):
        def call(*arguments, **options):
            self.calls.append((name, *arguments, *options.values()))
            return {"endpoints": ENDPOINTS, "routes": ROUTES, "reload": ["dialect changes later"]}.get(name)

        return call


ENDPOINTS = [
    {
        "name": "ground", "url": UDP, "state": "open", "reason": "", "links": ["ground"], "group": "radio",
        "pause": False, "listen_only": True, "received": 12, "received_bytes": 3400, "sent": 5,
        "sent_bytes": 6, "lost": 1, "bad_crc": 0, "dropped": {"rate": 7},
    }
]  # fmt: skip
ROUTES = [{"system": 1, "component": 1, "endpoints": ["ground"], "age": 0.25}]


@pytest.fixture
def client(monkeypatch):
    monkeypatch.setattr("mavstack.cli.route.control.ControlClient", FakeClient)
    return FakeClient


@pytest.mark.parametrize(
    ("words", "call"),
    [
        (["add", "tablet", UDP], ("add", "tablet", {"url": UDP})),
        (
            ["add", "tablet", UDP, "listen_only=true", "rate=20 kB/s", "rates.ATTITUDE=4"],
            ("add", "tablet", {"url": UDP, "listen_only": True, "rate": "20 kB/s", "rates": {"ATTITUDE": 4}}),
        ),
        (["set", "a", 'in.deny_messages=["GPS"]'], ("change", "a", {"in": {"deny_messages": ["GPS"]}})),
        (["remove", "tablet"], ("remove", "tablet")),
        (["pause", "tablet"], ("pause", "tablet", True)),
        (["resume", "tablet"], ("pause", "tablet", False)),
        (["reload"], ("reload",)),
    ],
)  # fmt: skip
def test_ctl_actions(mav, client, words, call):
    assert mav("route", "ctl", *words).code == 0
    assert client.last.calls == [call]


@pytest.mark.parametrize(
    ("action", "text"),
    [
        ("list", "ground    open   udpin://127.0.0.1:0      1  listen_only, group radio"),
        ("stats", "ground          12  3.4 kB     5  6 B     1        0  rate 7"),
        ("routes", "1/1      ground     0.2 s"),
    ],
)
def test_ctl_shows_tables_and_json(mav, client, action, text):
    assert mav("route", "ctl", action).out.splitlines()[1] == text
    assert json.loads(mav("route", "ctl", action, "--json").out)
    assert json.loads(mav("route", "ctl", "--json", action).out)  # an option may stand anywhere


def test_ctl_finds_the_router_and_the_token(mav, client, tmp_path, monkeypatch):
    path = tmp_path / "token"
    path.write_text("secret\n")
    mav("route", "ctl", "list", "--control", "10.0.0.1:1", "--token-file", str(path))
    assert (client.last.address, client.last.token) == ("10.0.0.1:1", "secret")
    monkeypatch.setenv("MAVSTACK_CONTROL_TOKEN", "other")
    mav("route", "ctl", "list")
    assert (client.last.address, client.last.token) == ("127.0.0.1:7272", "other")


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ([], "there is no endpoint"),
        (["ctl"], "ctl needs an action: list, stats"),
        (["ctl", "pause"], "ctl pause needs the name"),
        (["ctl", "pause", "a", "b"], "ctl pause needs one name"),
        (["ctl", "add", "a", "b"], "ctl add needs a name and a URL"),
        (["ctl", "set", "a", "b"], "'b' is not a setting of the form KEY=VALUE"),
        (["check"], "check needs one configuration file"),
        (["a.toml", "b.toml"], "one configuration file is needed"),
        ([UDP], "is a link: give links with -e"),
        (["a.toml", "--from", "b"], "either a configuration file or --from"),
        (["-e", "udpin://127.0.0.1:0?idel=5"], "did you mean idle"),
        (["-e", UDP, "--control", "0.0.0.0:1"], "--control must be an address of this machine"),
        (["-e", UDP, "--control", "here"], "--control must be a host and a port"),
    ],
)
def test_wrong_usage(mav, client, words, problem):
    result = mav("route", *words)
    assert result.code == 2
    assert problem in result.err


def test_check(mav, tmp_path):
    path = tmp_path / "router.toml"
    path.write_text(CONFIG)
    assert mav("route", "check", str(path)).out == f"{path}: valid, 1 endpoint\n"
    path.write_text(CONFIG.replace("url", "ulr"))
    result = mav("route", "check", str(path))
    assert result.code == 1
    assert result.err.startswith(f"mav route: {path}:")


def test_files_of_mavlink_router_are_printed_as_toml(mav, tmp_path):
    path = tmp_path / "main.conf"
    path.write_text("[UdpEndpoint a]\nMode = Normal\nAddress = 127.0.0.1\nColour = blue\n")
    result = mav("route", "--from", str(path), "--print")
    config = parse_config(result.out)
    assert [each.url for each in config.endpoints] == ["udpout://127.0.0.1:14550", "tcpin://0.0.0.0:5760"]
    assert result.err == f"mav route: {path}:4: colour is unknown and has no effect\n"


def test_a_key_is_for_the_links_of_the_command_line(mav, tmp_path):
    SigningKey.generate().save(key := tmp_path / "field.key")
    result = mav("route", "--key", key, "-e", "udpin://127.0.0.1:1", "--print")
    (endpoint,) = parse_config(result.out).endpoints
    assert endpoint.keys == SigningConfig(str(key), str(key))
    result = mav("route", "--key", tmp_path / "none.key", "-e", "udpin://127.0.0.1:1", "--print")
    assert (result.code, "signing_key is no key" in result.err) == (2, True)


def test_a_firewall_is_not_lost_when_a_configuration_is_printed(mav, tmp_path):
    (tmp_path / "router.toml").write_text(f"{CONFIG}[firewall]\n")
    result = mav("route", tmp_path / "router.toml", "--print")
    assert (result.code, result.out) == (2, "")
    assert "--print cannot write [firewall]: copy it from" in result.err


def test_examples_parse():
    assert command_parser("route").parse_args(["ctl", "list"]).words == ["ctl", "list"]
