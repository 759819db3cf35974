from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.cli.common.exposure import announce_exposure
from mavstack.links import parse_url


@pytest.mark.parametrize("url", ["udpin://0.0.0.0:14550", "tcpin://[::]:5760", "udpin://192.168.1.2:14550"])
def test_ports_that_other_hosts_reach_are_named(capsys, url):
    announce_exposure("param", [SimpleNamespace(url=parse_url(url))])
    assert capsys.readouterr().err.startswith(f"mav param: {parse_url(url)} can be reached from the network")


@pytest.mark.parametrize(
    "url", ["udpin://127.0.0.1:14550", "tcpin://localhost:5760", "udpout://10.0.0.1:14550"]
)
def test_other_links_are_not_mentioned(capsys, url):
    announce_exposure("param", [SimpleNamespace(url=parse_url(url))])
    assert capsys.readouterr().err == ""
