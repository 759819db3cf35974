from __future__ import annotations

import importlib
import subprocess
import sys
from importlib.metadata import EntryPoint, EntryPoints

import pytest

from mavstack.errors import LinkURLError
from mavstack.links import LinkURL, memory_pair, open_link
from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_table import ENTRY_POINTS, SCHEMES, builtin_schemes


@pytest.mark.parametrize("scheme", builtin_schemes().values(), ids=lambda each: each.name)
def test_every_scheme_has_a_backend(scheme):
    module, name = scheme.backend.split(":")
    assert callable(getattr(importlib.import_module(module), name))


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


@pytest.fixture
def install(monkeypatch):
    """Install plug-ins; returns the list to which each look-up of entry points adds."""
    monkeypatch.setitem(sys.modules, "links.test_registry", sys.modules[__name__])

    def install(**entries):
        lookups = []

        def plugins():
            lookups.append("lookup")
            return EntryPoints(
                EntryPoint(name.replace("_", "-"), f"links.test_registry:{target}", ENTRY_POINTS)
                for name, target in entries.items()
            )

        monkeypatch.setattr(SCHEMES, "plugins", plugins)
        return lookups

    return install


def test_other_packages_add_schemes(install):
    lookups = install(carrier_pigeon="open_pigeon")
    open_link("udpin://0.0.0.0:14550")
    assert not lookups
    link = open_link("carrier-pigeon://loft/7?speed=2")
    assert link.url == LinkURL("carrier-pigeon", path="loft/7", options={"speed": "2"})
    with pytest.raises(LinkURLError, match="unknown scheme 'owl'"):
        open_link("owl://post")


def test_the_url_of_a_plugin_is_read_by_its_record(install):
    install(pigeon="PIGEON")
    link = open_link("pigeon://loft?speed=2")
    assert link.url == LinkURL("pigeon", "loft", 1870, options={"speed": "2"})
    with pytest.raises(LinkURLError, match="it has no host; for example: pigeon://loft"):
        open_link("pigeon://:7")


def test_a_plugin_that_fails_is_an_error_only_for_its_own_urls(install, caplog):
    install(owl="MISSING", pigeon="PIGEON", hawk="PIGEON")
    for _ in range(2):
        with pytest.raises(LinkURLError, match="owl failed: AttributeError"):
            open_link("owl://post")
    with pytest.raises(LinkURLError, match="its scheme is named 'pigeon', its entry point 'hawk'"):
        open_link("hawk://post")
    assert open_link("pigeon://loft?speed=2").url.port == 1870
    assert [record.message.partition(":")[0] for record in caplog.records] == [
        "plug-in owl was left out",
        "plug-in hawk was left out",
    ]


PIGEON = LinkScheme(
    name="pigeon",
    backend="links.test_registry:open_pigeon",
    address=AddressKind.HOST,
    example="pigeon://loft",
    purpose="Carries packets by birds.",
    default_port=1870,
)


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
