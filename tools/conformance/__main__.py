"""Write the conformance corpus, or check that it is up to date."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tools.conformance.bootloader import bootloader_text
from tools.conformance.corpus import DIALECTS, corpus_text
from tools.conformance.msp import msp_text
from tools.conformance.surveys import survey_files

FOLDER = Path(__file__).resolve().parents[2] / "conformance"


def main() -> int:
    """Write or compare the files; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.conformance", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if a file is old")
    arguments = parser.parse_args()
    outdated = []
    files = {f"{name}.jsonl": corpus_text(name) for name in DIALECTS}
    files["msp.jsonl"] = msp_text()
    files["bootloader.jsonl"] = bootloader_text()
    files |= {f"survey/{name}": text for name, text in survey_files().items()}
    for name, text in files.items():
        path = FOLDER / name
        if path.is_file() and path.read_text("ascii") == text:
            continue
        outdated.append(path.name)
        if not arguments.check:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, "ascii")
    if arguments.check and outdated:
        print(f"out of date: {', '.join(outdated)}; run python -m tools.conformance", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
