"""Reading BVH: kinesic beside two readers from PyPI, in one run.

    target/peers/bin/python benches/peers/bvh.py target/release/kinesic CLIP.bvh WORK

CLIP's frames are repeated to 200 MB, and to 20 MB for those that take minutes. Each reader is a process of its own, five times (the
slow ones once): the median of wall and processor seconds, the most memory that it held. `kinesic inspect` also plays all frames.
"""
import os
import statistics
import subprocess
import sys
import time

READERS = {
    "pybvh": "import pybvh; pybvh.read_bvh_file(FILE)",
    "bvh": "import bvh; bvh.Bvh(open(FILE).read()).frames",
}


def repeated(source, target, size):
    """Frames of a clip over and over, until the file has about so many bytes."""
    head, body = open(source).read().replace("\r", "").split("MOTION", 1)
    lines = [line for line in body.split("\n") if line.strip()]
    frames = "\n".join(lines[2:]) + "\n"
    times = max(1, size // len(frames))
    with open(target, "w") as out:
        out.write(f"{head}MOTION\nFrames: {times * (len(lines) - 2)}\n{lines[1]}\n")
        for _ in range(times):
            out.write(frames)
    return times * (len(lines) - 2)


def run(command):
    """Wall seconds, processor seconds and most bytes of one process."""
    start = time.monotonic()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    assert status == 0, f"{command} failed"
    return time.monotonic() - start, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024


def row(name, path, command, runs):
    size = os.path.getsize(path)
    took = [run(command) for _ in range(runs)]
    wall, cpu = (statistics.median(t[i] for t in took) for i in (0, 1))
    memory = max(t[2] for t in took) / size
    print(f"| {name} | {size / 1e6:.0f} | {wall:.2f} | {cpu:.2f} | {size / 1e6 / wall:.0f} | {size / 1e6 / cpu:.0f} | {memory:.2f} |", flush=True)


def main():
    kinesic, clip, work = sys.argv[1:4]
    others = sys.argv[4:]
    os.makedirs(work, exist_ok=True)
    large, small = (os.path.join(work, name) for name in ("large.bvh", "small.bvh"))
    print(f"{repeated(clip, large, 200_000_000)} frames, and {repeated(clip, small, 20_000_000)}; {os.getloadavg()[0]:.1f} others at work")
    print("| reader | file, MB | wall, s | processor, s | MB/s | MB a processor second | memory / file |")
    print("|---|---|---|---|---|---|---|")
    for other in others:
        row(f"kinesic inspect, {os.path.basename(other)}", large, [other, "inspect", large], 5)
    for path in (large, small):
        row("kinesic inspect", path, [kinesic, "inspect", path], 5)
    for name, code in READERS.items():
        path = large if name == "pybvh" else small
        row(name, path, [sys.executable, "-c", code.replace("FILE", repr(path))], 1 if path == small else 3)


main()
