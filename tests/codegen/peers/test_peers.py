"""Other libraries over the conformance corpus: valid packets mean the same to them.

The table of docs/guides/code-generation.md has their results; `python -m tests.codegen.peers` prints it.
"""

from __future__ import annotations

import pytest

from tests.codegen.peers.results import PEERS, Peer, found, repacked

#: Categories of valid packets, without damage, signatures and unusual headers.
VALID = "message"


@pytest.mark.interop
@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_every_message_has_the_same_fields(peer: Peer, tmp_path):
    results = [result for result in peer.run("common", tmp_path) if result.category == VALID]
    assert len(results) > 200
    assert [result.name for result in results if not found(result)] == []
    assert sum(repacked(result) for result in results) >= peer.min_repacked
