from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.server.rows.urls import is_row_url, parse_row_url


def test_a_url_names_link_template_and_source() -> None:
    url = parse_row_url(
        "csv+serial:///dev/ttyUSB0?baud=9600&name=cansat&template=$GPS,lat,lon|time:s,alt:m*0.1"
    )
    assert (url.link.scheme, url.link.path, dict(url.link.options)) == (
        "serial",
        "/dev/ttyUSB0",
        {"baud": "9600"},
    )
    assert url.name == "cansat"
    assert [each.message for each in url.templates] == ["GPS", "ROW"]
    assert parse_row_url("csv+tcp://10.0.0.1:5770?template=a").link.scheme == "tcpout"


@pytest.mark.parametrize(
    ("text", "error", "reason"),
    [
        ("csv+tcp://127.0.0.1:5770", LinkURLError, r"no template.*\?template=time:s"),
        ("csv+tcp://127.0.0.1:5770?template=1a", InvalidArgumentError, "not a column"),
        ("csv+tcp://127.0.0.1:5770?template=a&name=1/1", LinkURLError, "name of a source"),
        ("csv+tcp://127.0.0.1?template=a", LinkURLError, "port"),
    ],
)
def test_malformed_urls(text: str, error: type[Exception], reason: str) -> None:
    with pytest.raises(error, match=reason):
        parse_row_url(text)


def test_row_urls_are_not_links() -> None:
    assert is_row_url("CSV+TCP://127.0.0.1:1?template=a")
    assert not is_row_url("tcpout://127.0.0.1:1")
    assert not is_row_url("csv+ftp://127.0.0.1:1")
