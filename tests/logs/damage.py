"""Random damage of files, for tests of repairs."""

from __future__ import annotations


def damaged(data, rng, *, first=0, places=3):
    """Return a file with random damage behind `first`, and the ranges of the original that are not damaged.

    Bytes are overwritten, removed or inserted, and the end may be cut off.
    """
    content, sound, position = bytearray(data[:first]), [(0, first)], first
    for place in sorted(rng.randrange(first, len(data)) for _ in range(places)):
        if place < position:
            continue
        content += data[position:place]
        sound.append((position, place))
        kind = rng.choice(["overwrite", "remove", "insert", "zero"])
        # Where as many bytes are missing as some records have, these look like the end of another one.
        sizes = [1, 7, 43] if kind == "remove" else [1, 7, 50, 700]
        size = min(rng.choice(sizes), len(data) - place)
        if kind != "remove":
            content += bytes(size) if kind == "zero" else rng.randbytes(size)
        position = place if kind == "insert" else place + size
    end = rng.choice([len(data), rng.randrange(position, len(data) + 1)])
    content += data[position:end]
    sound.append((position, end))
    return bytes(content), sound


def survivors(records, sound, followers=0):
    """Return the records that a repair must find: those with sound neighbours.

    Args:
        records: Begin and end of each record in the original.
        sound: Ranges of the original that are not damaged.
        followers: Number of sound records that must follow, besides the header of another one.
    """
    header = 3
    ends = [end for _, end in records]
    return [
        (start, end)
        for number, (start, end) in enumerate(records)
        if any(
            first <= start and ends[min(number + followers, len(ends) - 1)] + header <= last
            for first, last in sound
        )
    ]
