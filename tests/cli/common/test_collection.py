from __future__ import annotations

import gc

from mavstack.cli.common.collection import no_collection


def test_the_collector_is_off_and_leaves_out_what_was_made():
    frozen = gc.get_freeze_count()
    try:
        with no_collection():
            assert not gc.isenabled()
        assert gc.isenabled()
        assert gc.get_freeze_count() > frozen
    finally:
        gc.unfreeze()
