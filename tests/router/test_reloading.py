from __future__ import annotations

import pytest

from mavstack.errors import RouterConfigError
from mavstack.router.reloading import ConfigFile
from tests.router.peers import routing

ENDPOINT = '[endpoint.{}]\nurl = "udpin://127.0.0.1:0"\n'


@pytest.fixture
def path(tmp_path):
    return tmp_path / "router.toml"


async def test_a_changed_file_is_loaded_when_it_has_settled(path):
    path.write_text(ENDPOINT.format("a"))
    async with routing() as router:
        file = ConfigFile(str(path), router)
        assert not await file.look()
        path.write_text(ENDPOINT.format("a") + ENDPOINT.format("b"))
        assert not await file.look()
        assert await file.look()
        assert sorted(router.endpoints) == ["a", "b"]
        assert not await file.look()


async def test_a_file_that_is_not_valid_changes_nothing(path, caplog):
    path.write_text(ENDPOINT.format("a"))
    async with routing() as router:
        file = ConfigFile(str(path), router)
        await file.reload()
        path.write_text("[endpoint.b]\n")
        await file.look()
        assert await file.look()
        assert "router.toml:1: endpoint.b has no url; the configuration in use stays" in caplog.text
        assert sorted(router.endpoints) == ["a"]
        with pytest.raises(RouterConfigError, match="has no url"):
            await file.reload()


async def test_a_missing_file_changes_nothing(path):
    path.write_text(ENDPOINT.format("a"))
    async with routing() as router:
        file = ConfigFile(str(path), router)
        await file.reload()
        path.unlink()
        assert not await file.look()
        assert not await file.look()
        assert sorted(router.endpoints) == ["a"]


@pytest.mark.parametrize("content", ["", "# nothing\n", "[router]\n"])
async def test_an_empty_file_changes_nothing(path, caplog, content):
    path.write_text(ENDPOINT.format("a"))
    async with routing() as router:
        file = ConfigFile(str(path), router)
        await file.reload()
        path.write_text(content)
        await file.look()
        assert await file.look()
        assert "has no endpoints" in caplog.text
        assert sorted(router.endpoints) == ["a"]
        with pytest.raises(RouterConfigError, match="no endpoints"):
            await file.reload()
