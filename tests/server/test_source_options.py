"""Answers of a station without a password do not say whether a file exists."""

from __future__ import annotations

import pytest

from mavstack.errors import SigningError
from mavstack.http.bodies import RefusedError
from mavstack.security import SigningKey
from mavstack.server.station import Station

OPTIONS = ["signing_key", "ca", "cert", "key", "roles", "ticket_key"]
SCHEMES = {
    "signing_key": "udpin://127.0.0.1:0",
    "ticket_key": "wsin://127.0.0.1:0",
    "roles": "tcpin://127.0.0.1:0",
}


async def problem(url: str, **options: bool) -> str:
    async with Station(telemetry=False, network_only=True) as station:
        with pytest.raises(RefusedError) as caught:
            await station.sources.add(url, from_client=True, **options)
    return str(caught.value)


@pytest.mark.parametrize("option", OPTIONS)
async def test_a_file_that_exists_is_refused_as_one_that_does_not(option, tmp_path, monkeypatch):
    """Before: the texts were "cannot read the key file …: FileNotFoundError", "… ValueError" and others."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "present.pem").write_text("not a key\n")
    (tmp_path / "folder").mkdir()
    url = SCHEMES.get(option, "tls://127.0.0.1:9")
    values = ["present.pem", "absent.pem", "folder/", f"{tmp_path}/present.pem", "/etc/shadow", "~/x"]
    texts = {await problem(f"{url}?{option}={value}") for value in values}
    assert texts == {f"without a password no file can be named: leave out {option}, or set a password"}


async def test_names_of_keys_have_one_error(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    folder = tmp_path / "mavstack" / "keys"
    folder.mkdir(parents=True)
    (folder / "damaged.key").write_text("not a key")
    texts = {await problem(f"udpin://127.0.0.1:0?signing_key={name}") for name in ("damaged", "absent")}
    assert texts == {"the link cannot be opened: signing_key cannot be used"}
    SigningKey.generate().save(folder / "field.key")
    async with Station(telemetry=False, network_only=True) as station:
        await station.sources.add("udpin://127.0.0.1:0?signing_key=field", from_client=True)


async def test_a_station_with_passwords_names_the_reason(tmp_path):
    async with Station(telemetry=False) as station:
        with pytest.raises(SigningError, match=r"cannot read the key file .*absent"):
            await station.sources.add(f"udpin://127.0.0.1:0?signing_key={tmp_path}/absent", from_client=True)
