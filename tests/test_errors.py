"""The texts of errors."""

from __future__ import annotations

import pickle

from mavstack.errors import CommandDenied


def test_a_renamed_error_has_the_name_of_its_action():
    error = CommandDenied("COMPONENT_ARM_DISARM on", "1/1", answer="FAILED", code=4)
    error.status_texts = ("Arm: no position",)
    error.rename("arming")
    assert str(error) == "arming 1/1 failed: FAILED (Arm: no position)"
    assert error.operation == "arming"
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.code) == (str(error), 4)
