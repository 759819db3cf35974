from __future__ import annotations

import pytest

from mavstack.router.config.quantities import byte_rate, byte_size, duration, hertz


@pytest.mark.parametrize(
    ("convert", "value", "number"),
    [
        (duration, 0.5, 0.5),
        (duration, "500 ms", 0.5),
        (duration, "10min", 600),
        (duration, "1 h", 3600),
        (byte_size, "100 MB", 100_000_000),
        (byte_size, "64 KiB", 65_536),
        (byte_rate, 20_000, 20_000),
        (byte_rate, "20 kB/s", 20_000),
        (byte_rate, "57.6 kbit/s", 7_200),
        (hertz, 4, 4),
        (hertz, "0.2 Hz", 0.2),
        (hertz, "6/min", 0.1),
    ],
)
def test_numbers_and_texts_with_units(convert, value, number):
    assert convert(value) == pytest.approx(number)


@pytest.mark.parametrize(
    "value", ["", "x", "-1", -1, True, None, [], float("nan"), float("inf"), 10**400, "1 parsec"]
)
@pytest.mark.parametrize("convert", [duration, byte_size, byte_rate, hertz])
def test_others_are_refused_with_an_example(convert, value):
    with pytest.raises(ValueError, match="such as"):
        convert(value)
