from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.main import main
from mavstack.cli.shell.runner import run_line
from mavstack.links import LinkURL, parse_url
from mavstack.links.scheme_table import builtin_schemes
from tests.cli.shell.shell_session import alone


@pytest.mark.parametrize("url", ["udpin://0.0.0.0:14550", "tcpin://[::]:5760", "udpin://192.168.1.2:14550"])
def test_ports_that_other_hosts_reach_are_named(capsys, url):
    announce_exposure("param", [SimpleNamespace(url=parse_url(url))])
    assert capsys.readouterr().err.startswith(f"mav param: {parse_url(url)} can be reached from the network")


@pytest.mark.parametrize("scheme", builtin_schemes().values(), ids=lambda each: each.name)
def test_listeners_of_every_network_scheme_are_named(capsys, scheme):
    """Sealed links too."""
    announce_exposure("param", [SimpleNamespace(url=LinkURL(scheme.name, "0.0.0.0", 1))])
    assert ("from the network" in capsys.readouterr().err) is (scheme.is_network and scheme.listens)


@pytest.mark.parametrize(
    "url", ["udpin://127.0.0.1:14550", "tcpin://localhost:5760", "udpout://10.0.0.1:14550"]
)
def test_other_links_are_not_mentioned(capsys, url):
    announce_exposure("param", [SimpleNamespace(url=parse_url(url))])
    assert capsys.readouterr().err == ""


def test_the_demo_names_its_ports(capsys):
    assert main(["demo", "--out", "tcpin://0.0.0.0:0", "--once", "--for", "0.2", "--speed", "1000"]) == 0
    captured = capsys.readouterr()
    assert captured.err.startswith("mav demo: tcpin://0.0.0.0:")
    assert "can be reached from the network" in captured.err


def test_outputs_of_the_shell_are_named(capsys):
    async def scenario(session):
        await run_line(session, "output add tcpin://0.0.0.0:0")

    alone(scenario)
    assert capsys.readouterr().err.startswith("mav shell: tcpin://0.0.0.0:")


def test_many_ports_are_one_line(capsys):
    announce_exposure(
        "sim", [SimpleNamespace(url=parse_url(f"tcpin://0.0.0.0:{port}")) for port in range(5760, 5860)]
    )
    text = "tcpin://0.0.0.0:5760 … tcpin://0.0.0.0:5859 can be reached from the network"
    assert capsys.readouterr().err.startswith(f"mav sim: {text}")
