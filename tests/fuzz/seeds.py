#!/usr/bin/env python3
"""Fills tests/fuzz/corpus with inputs made of the files of this repository."""

import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
CORPUS = Path(sys.argv[1] if len(sys.argv) > 1 else REPOSITORY / "tests/fuzz/corpus")


def put(target, name, content):
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)


def texts(target, *patterns):
    for path in sorted(path for pattern in patterns for path in REPOSITORY.glob(pattern)):
        put(target, f"{path.parent.name}-{path.stem}", path.read_bytes())


def frames():
    """Each file of frames on each framing: every request whole, as targets/frames.rs reads it."""
    for path in sorted(REPOSITORY.glob("tests/frames/*/*.txt")):
        requests = re.findall(r"^>> ([0-9A-F]{2}(?: [0-9A-F]{2})+)", path.read_text(), re.M)
        # The checksum is put on anew.
        pieces = [bytes.fromhex(request)[:-2][:255] for request in requests]
        pieces = b"".join(bytes([1, len(piece)]) + piece + bytes([2, 10]) for piece in pieces)
        for framing in range(4):
            put("frames", f"{path.parent.name}-{path.stem}-{framing}", bytes([framing]) + pieces)


def faults():
    """The examples of the page, one a file."""
    page = (REPOSITORY / "docs/faults.md").read_text()
    examples = set(re.findall(r"`([a-z_]+(?::[^`\s]+)?)`", page))
    for i, example in enumerate(sorted(examples)):
        put("faults", f"page-{i}", example.encode())


frames()
faults()
texts("model", "tests/models/*.yaml", "tests/problems/model/*.yaml")
texts("bench", "tests/problems/bench/*.yaml")
texts("scenario", "tests/problems/scenario/*.yaml")
