"""The options of links on the command line."""

from __future__ import annotations

from argparse import ArgumentParser

import pytest

from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.registry import COMMANDS, actions_of, command_parser
from mavstack.security import SigningKey

OPTIONS = {"--key", "--id", "--mavlink", "--heartbeat-rate"}
#: Commands whose components are simulated vehicles, with ids of their own.
SIMULATIONS = {"sim", "demo"}
#: Commands that speak another protocol with the device of their URL.
OTHER_PROTOCOLS = {"radio", "msp", "simulator"}
#: Commands that send no packets of their own.
ROUTERS = {"route"}


def urls(*words: str, url: str = "udpin://0.0.0.0:14550") -> list[str]:
    parser = ArgumentParser()
    add_link_options(parser)
    return with_link_options([url], parser.parse_args(words))


def test_options_become_those_of_the_url():
    assert urls("--key", "fleet", "--id", "245/191", "--mavlink", "auto", "--heartbeat-rate", "2") == [
        "udpin://0.0.0.0:14550?signing_key=fleet&id=245/191&mavlink=auto&heartbeat_rate=2"
    ]


def test_a_url_keeps_its_own_options():
    url = "udpin://0.0.0.0:14550?mavlink=1"
    assert urls("--mavlink", "2", "--id", "7", url=url) == ["udpin://0.0.0.0:14550?id=7&mavlink=1"]


def test_without_options_the_url_stays_as_it_is():
    assert urls(url="udp:0.0.0.0:14550") == ["udp:0.0.0.0:14550"]


@pytest.mark.parametrize(
    "words", [("--id", "0"), ("--id", "1/256"), ("--id", "x"), ("--mavlink", "3"), ("--heartbeat-rate", "-1")]
)
def test_wrong_values_are_refused(words, capsys):
    with pytest.raises(SystemExit):
        urls(*words)
    assert words[0] in capsys.readouterr().err


def test_every_command_that_opens_a_link_has_the_options():
    for name in COMMANDS.keys() - OTHER_PROTOCOLS:
        command = command_parser(name)
        for parser in [command, *(action for _, _, action in actions_of(command))]:
            known = set(parser._option_string_actions)
            destinations = {action.dest for action in parser._actions}
            opens = not destinations.isdisjoint({"url", "out", "endpoint"}) or name in ("watch", "record")
            if opens:
                wanted = OPTIONS - ({"--id", "--heartbeat-rate"} if name in SIMULATIONS else set())
                wanted &= {"--key"} if name in ROUTERS else OPTIONS
                wanted -= {"--key"} if parser.prog == "mav key rotate" else set()  # NAME is the key
                assert wanted <= known, f"{parser.prog} lacks {sorted(wanted - known)}"


def test_a_command_talks_with_the_ids_and_the_key_that_it_is_given(mav, simulate, tmp_path):
    harness = simulate()
    key = tmp_path / "fleet.key"
    SigningKey.generate().save(key)
    assert mav("vehicle", "info", "--id", "77", "--heartbeat-rate", "4").code == 0
    assert harness.urls == ("udpin://0.0.0.0:14550?id=77&heartbeat_rate=4",)
    result = mav("vehicle", "info", "--key", tmp_path / "none.key", "--url", "udpin://127.0.0.1:0")
    assert harness.urls[-1].startswith("udpin://127.0.0.1:0?signing_key=")
    assert result.code in (0, 1)
