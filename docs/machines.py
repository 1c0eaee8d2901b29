"""Compares the numbers of two packs, tensor by tensor: what docs/machines.sh runs.

    python3 docs/machines.py KINESIC KIND A.kin B.kin "A B"    one row of the table of docs/reliability.md
"""
import json
import struct
import subprocess
import sys

KINDS = {"F32": "f", "U16": "H", "I8": "b", "I16": "h", "I32": "i"}


def tensors(kinesic, path):
    """Names and numbers in the order of the payload: each tensor begins at a multiple of 16."""
    data = open(path, "rb").read()
    start = len(data) - struct.unpack_from("<I", data, 12)[0]
    found = json.loads(subprocess.run([kinesic, "inspect", path, "--json"], capture_output=True, check=True).stdout)
    out, at = {}, start
    for name, kind, shape in found["tensors"]:
        code = KINDS[kind.upper()]
        at += -(at - start) % 16
        count = shape[0] * shape[1]
        out[name] = struct.unpack_from(f"<{count}{code}", data, at)
        at += count * struct.calcsize(code)
    assert -(at - len(data)) < 16, f"{path}: {len(data) - at} bytes are no tensor's"
    return out


def main():
    kinesic, kind, first, second, pair = sys.argv[1:]
    a, b = tensors(kinesic, first), tensors(kinesic, second)
    pair = pair.replace(" ", " / ")
    if [(n, len(v)) for n, v in a.items()] != [(n, len(v)) for n, v in b.items()]:
        print(f"| {kind} | {pair} | | **other shapes** | |")
        return
    total = differ = 0
    worst, where = 0.0, ""
    for name, values in a.items():
        total += len(values)
        pairs = [(x, y) for x, y in zip(values, b[name]) if struct.pack("<d", x) != struct.pack("<d", y)]
        differ += len(pairs)
        if pairs:
            share = max(abs(x - y) for x, y in pairs) / max(abs(x) for x in (*values, *b[name]))
            if share > worst:
                worst, where = share, name
    print(f"| {kind} | {pair} | {total:,} | {differ:,} | {f'{worst:.1e} ({where})' if differ else '0'} |")


main()
