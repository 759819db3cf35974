"""The conformance corpus: inputs for parsers of MAVLink in any language, and what they must make of them.

    python -m tools.conformance            # write conformance/*.jsonl
    python -m tools.conformance --check    # fail if a file is out of date

The inputs follow from fixed seeds, the expected results from the core of Mavstack. conformance/README.md
describes the format.
"""
