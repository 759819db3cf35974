"""Print the table of the peers: python -m tests.codegen.peers."""

from __future__ import annotations

import tempfile
from collections import Counter
from pathlib import Path

from tests.codegen.peers.results import PEERS, found, repacked


def main() -> None:
    """Run every peer over the corpus of common, and print inputs with the right packets by category."""
    columns: list[tuple[str, Counter[str], int]] = []
    totals: Counter[str] = Counter()
    for peer in PEERS:
        with tempfile.TemporaryDirectory() as folder:
            results = peer.run("common", Path(folder))
        totals = Counter(result.category for result in results)
        right = Counter(result.category for result in results if found(result))
        packed = sum(repacked(result) for result in results if result.category == "message")
        columns.append((peer.name, right, packed))
    print("| inputs | " + " | ".join(["all", *(name for name, _, _ in columns)]) + " |")
    print("|---|" + "---|" * (len(columns) + 1))
    for category, total in totals.items():
        cells = [str(right[category]) for _, right, _ in columns]
        print(f"| `{category}` | {total} | " + " | ".join(cells) + " |")
    cells = [str(packed) for _, _, packed in columns]
    print(f"| `message`, packed to the same bytes | {totals['message']} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
