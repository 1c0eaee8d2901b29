"""Writes what `kinesic-firmware-sim check --json FILE` measured into the tables of docs/latency.md, and its times into the reports:
`docs/latency.py FILE`. Which workloads a table has is the page's; whole numbers have commas."""

import json
import pathlib
import re
import sys

CORES = {
    "m0plus": "M0+ 133 MHz, no FPU",
    "rv32imc": "RV32IMC 160 MHz, no FPU",
    "m4f": "M4F 168 MHz",
    "m33": "M33 150 MHz",
    "m55": "M55 160 MHz",
    "m7": "M7 480 MHz",
}
here = pathlib.Path(__file__).parent
results = json.load(open(sys.argv[1]))["results"]
found = {(r["workload"], r["target"]): r for r in results}


def time_row(workload, target):
    r = found[workload, target]
    low, high = r["instructions"]["min"], r["instructions"]["max"]
    count = f"{low:,}" if low == high else f"{low:,} .. {high:,}"
    cycles = r["modelled_cycles"]
    spread = "" if cycles["low"] == cycles["high"] else f" [{cycles['low']:,.0f} .. {cycles['high']:,.0f}]"
    return (
        f"| {workload} | {CORES[target]} | {count} | {r['gated_cycles']:,.0f}{spread} "
        f"| {r['microseconds']:,.0f} | {r['share_of_frame_percent']:.2f} % |"
    )


def memory_row(workload):
    of = [r for r in results if r["workload"] == workload]
    flash = [r["flash"] / 1000 for r in of]
    most = {key: max(r[key] for r in of) for key in ("pack", "ram", "stack", "stack_start_up")}
    return (
        f"| `{workload}` | {min(flash):.1f} .. {max(flash):.1f} | {most['pack']:,} | {most['ram']:,} "
        f"| {most['stack']:,} / {most['stack_start_up']:,} |"
    )


def page(line):
    times = re.match(r"\| ([\w-]+) \| (" + "|".join(map(re.escape, CORES.values())) + r") \|", line)
    if times and (times[1], "m4f") in found:
        if times[2] != CORES["m0plus"]:
            return None
        return "\n".join(time_row(times[1], target) for target in CORES)
    memory = re.match(r"\| `([\w-]+)` \| [\d.]+ \.\. [\d.]+ \|", line)
    return memory_row(memory[1]) if memory else line


path = here / "latency.md"
lines = [page(line) for line in path.read_text().split("\n")]
path.write_text("\n".join(line for line in lines if line is not None))

path = here.parent / "host/src/report/latency.rs"


def times(match):
    row = [f"{found[match[2], target]['microseconds']:,.0f}".replace(",", "_") for target in CORES]
    return f"{match[1]}{', '.join(row)}]"


text = re.sub(r'(name: "([\w-]+)",\s*size: "[^"]*",\s*microseconds: \[)[^\]]*\]', times, path.read_text())
path.write_text(text)
