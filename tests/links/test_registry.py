from __future__ import annotations

import importlib
import subprocess
import sys
from importlib.metadata import EntryPoint, EntryPoints

import pytest

from mavstack.errors import LinkURLError
from mavstack.links import LinkURL, memory_pair, open_link, registry
from mavstack.links.url import EXAMPLES


def test_every_scheme_has_a_backend():
    assert set(registry.BACKENDS) == set(EXAMPLES)
    for target in set(registry.BACKENDS.values()):
        module, name = target.split(":")
        assert callable(getattr(importlib.import_module(f"mavstack.links.{module}"), name))


def test_an_unknown_option_raises_with_a_suggestion():
    with pytest.raises(LinkURLError, match=r"serial has no option 'buad'; did you mean baud\?"):
        open_link("serial:///dev/ttyACM0?buad=57600")
    with pytest.raises(LinkURLError, match="has no option 'color'"):
        open_link("udpin://0.0.0.0:14550", color="red")


def test_an_existing_file_needs_no_scheme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "recording").write_bytes(b"")
    assert open_link("recording").url == LinkURL("file", path="recording")
    with pytest.raises(LinkURLError, match="no scheme"):
        open_link("missing")


def test_a_memory_url_needs_a_network():
    with pytest.raises(LinkURLError, match=r"MemoryNetwork\(\)\.link\('memory://fleet'\)"):
        open_link("memory://fleet")


def test_other_packages_add_schemes(monkeypatch):
    lookups = []

    def entry_points():
        lookups.append("lookup")
        return EntryPoints(
            [EntryPoint("carrier-pigeon", "links.test_registry:open_pigeon", "mavstack.links")]
        )

    monkeypatch.setattr(registry, "plugins", entry_points)
    monkeypatch.setitem(sys.modules, "links.test_registry", sys.modules[__name__])
    open_link("udpin://0.0.0.0:14550")
    assert not lookups
    link = open_link("carrier-pigeon://loft/7?speed=2")
    assert link.url == LinkURL("carrier-pigeon", path="loft/7", options={"speed": "2"})
    with pytest.raises(LinkURLError, match="unknown scheme 'owl'"):
        open_link("owl://post")


def open_pigeon(url, options):
    options.text("speed")
    link = memory_pair()[0]
    link.url = url
    return link


def test_backends_are_imported_on_first_use():
    program = (
        "import sys, mavstack.links as links; links.open_link('udpin://0.0.0.0:0');"
        "print([m for m in ('serial', 'websockets', 'mavstack.links.tls') if m in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
