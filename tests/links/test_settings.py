"""The options of link URLs that the node of the link applies."""

from __future__ import annotations

import pytest

from mavstack.errors import LinkURLError
from mavstack.links import LinkSettings, open_link


def test_a_url_gives_its_settings():
    link = open_link("udpin://127.0.0.1:0?signing_key=fleet&id=245/191&mavlink=auto&heartbeat_rate=2.5")
    assert link.settings == LinkSettings("fleet", 245, 191, "auto", 2.5)
    assert link.settings.given == ["signing_key", "id", "mavlink", "heartbeat_rate"]
    assert "fleet" not in link.url.redacted


def test_a_url_without_them_gives_none():
    settings = open_link("udpin://127.0.0.1:0").settings
    assert settings == LinkSettings()
    assert settings.given == []
    assert open_link("udpin://127.0.0.1:0?id=7").settings == LinkSettings(system=7)


def test_an_impaired_link_has_the_settings_of_its_url():
    assert open_link("udpin://127.0.0.1:0?loss=0.5&mavlink=1").settings.version == 1


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("id=0", "SYSTEM or SYSTEM/COMPONENT, each 1 to 255"),
        ("id=256", "SYSTEM or SYSTEM/COMPONENT"),
        ("id=1/2/3", "SYSTEM or SYSTEM/COMPONENT"),
        ("id=", "SYSTEM or SYSTEM/COMPONENT"),
        ("mavlink=3", "1, 2 or auto"),
        ("heartbeat_rate=-1", "a rate from 0"),
        ("heartbeat_rate=51", "a rate from 0"),
        ("heartbeat_rate=nan", "a rate from 0"),
    ],
)
def test_a_malformed_setting_is_refused(query, expected):
    with pytest.raises(LinkURLError, match=expected):
        open_link(f"udpin://127.0.0.1:0?{query}")
