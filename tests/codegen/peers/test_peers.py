"""Other libraries over the conformance corpus: valid packets mean the same to them.

The table of docs/guides/code-generation.md has their results; `python -m tests.codegen.peers` prints it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.codegen.peers.results import PEERS, Peer, found, repacked

if TYPE_CHECKING:
    from _pytest.mark import ParameterSet

#: Categories of valid packets, without damage, signatures and unusual headers.
VALID = "message"


def cases() -> list[ParameterSet]:
    """Return the peers; those that npm and Go install are nightly."""
    tiers = dict.fromkeys(("node-mavlink", "gomavlib"), pytest.mark.nightly)
    return [
        pytest.param(peer, id=peer.name, marks=tiers.get(peer.name, pytest.mark.interop)) for peer in PEERS
    ]


@pytest.mark.parametrize("peer", cases())
def test_messages_have_the_same_fields(peer: Peer, tmp_path):
    results = [result for result in peer.run("common", tmp_path) if result.category == VALID]
    assert sum(map(found, results)) >= peer.min_found
    assert sum(map(repacked, results)) >= peer.min_repacked
