#!/usr/bin/env python3
"""Offsets the faces of every corpus part (phront offset --surfaces) at several distances.

    tests/corpus/run_surfaces.py                    # all parts, all distances
    tests/corpus/run_surfaces.py --parts 'thor__*' --percent 2 -2

Prints a line for each case, each face that failed or misses the tolerance (1 % of |d|), and the sum.
Distances are percent of the part's bounding-box diagonal. Exit: 0, or 1 when a face failed or missed,
or the program crashed or hung; 77 when the corpus is not there.
"""

import argparse
import concurrent.futures
import csv
import fnmatch
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from run_corpus import PERCENT, ROOT, SHARED, SKIPPED, run

TIME_LIMIT = 75  # s, of the program for one part


def run_case(phront: Path, part: Path, diagonal: float, percent: float, folder: Path) -> dict:
    distance = float(f"{percent / 100 * diagonal:.9g}")
    base = folder / f"{part.stem}{percent:+g}"
    report = base.with_suffix(".json")
    command = [str(phront), "offset", "--surfaces", str(part), f"--distance={distance!r}", "--keep"]
    command += ["--report", str(report), "--threads", "1", "-o", f"{base}.step"]
    code, _, err, seconds = run(command, 4 * TIME_LIMIT)
    try:
        data = json.loads(report.read_text())
        faces = [face for body in data["bodies"] for face in body["faces"]]
        tolerance = data["tolerance_mm"]
    except (OSError, json.JSONDecodeError):
        faces, tolerance = [], 0.0
    return {
        "name": part.stem,
        "percent": percent,
        "code": "hang" if code is None else code,
        "error": err.strip().splitlines()[-1] if err.strip() else "",
        "faces": faces,
        "tolerance": tolerance,
        "seconds": seconds,
    }


def bad_faces(case: dict) -> list[str]:
    lines = []
    for number, face in enumerate(case["faces"], 1):
        if face["kind"] == "failed":
            lines.append(f"face {number} ({face['type']}): {face['trouble']}")
        elif face["deviation_mm"] > case["tolerance"]:
            share = face["deviation_mm"] / case["tolerance"]
            lines.append(f"face {number} ({face['type']}): {share:.2f} times the tolerance")
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--phront", type=Path, default=ROOT / "build/release/phront")
    parser.add_argument("--parts", nargs="*", default=["*"])
    parser.add_argument("--percent", nargs="*", type=float, default=PERCENT)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    manifest = SHARED / "corpus/MANIFEST.csv"
    if not manifest.exists():
        print("SKIPPED: no corpus")
        return SKIPPED
    with open(manifest, newline="") as stream:
        rows = list(csv.DictReader(stream))
    rows = [r for r in rows if any(fnmatch.fnmatch(r["name"], p) for p in arguments.parts)]
    cases = [
        (SHARED / "corpus" / row["name"], float(row["diag_mm"]), percent)
        for percent in arguments.percent
        for row in rows
    ]
    kinds: dict[str, int] = {}
    bad = crashed = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(
        arguments.jobs
    ) as pool:
        for case in pool.map(
            lambda c: run_case(arguments.phront, *c, Path(folder)), cases
        ):
            troubles = bad_faces(case)
            for face in case["faces"]:
                kinds[face["kind"]] = kinds.get(face["kind"], 0) + 1
            bad += len(troubles)
            broken = not case["faces"]
            crashed += broken
            print(
                f"{case['name']:44.44} {case['percent']:+5.1f} %  exit {case['code']}"
                f"  {len(case['faces']):4} faces, {len(troubles)} bad  {case['seconds']:6.1f} s"
                f"{'  ' + case['error'] if broken else ''}",
                flush=True,
            )
            for line in troubles[:12]:
                print(f"    {line}")
    total = sum(kinds.values())
    print(f"{len(cases)} cases, {total} faces: {kinds}")
    print(
        f"within the tolerance or vanished: {total - bad} ({100 * (total - bad) / max(total, 1):.2f} %);"
        f" parts without a report: {crashed}"
    )
    return 1 if bad or crashed else 0


if __name__ == "__main__":
    sys.exit(main())
