#!/usr/bin/env python3
"""Hollows every corpus solid, its largest planar face open, beside OpenCASCADE's MakeThickSolid.

    tests/corpus/run_shells.py                      # all single solids, wall 1 % of the diagonal
    tests/corpus/run_shells.py --parts 'thor__*' --percent 2

Both results are measured by `phront check`: a valid closed solid whose wall has its thickness to 1 %
(99 % of the wall) and lacks nothing. Results go to <out>/shells.jsonl; a part that is there is not run
again. Needs phront and phront_thick_solid (PHRONT_BENCHMARKS=ON). Exit: 0; 1 when phront crashed,
hung or said 0 for a shell that its check fails; 77 when the corpus is not there.
"""

import argparse
import csv
import fnmatch
import json
import sys
import tempfile
from pathlib import Path

from run_corpus import ROOT, SHARED, SKIPPED, run


def largest_plane(phront: Path, part: Path) -> tuple[str | None, float]:
    """Id of the largest planar face of a file that holds one solid, and the diagonal in mm."""
    code, text, _, _ = run([str(phront), "info", str(part), "--report", "-"], 120)
    if code != 0:
        return None, 0
    info = json.loads(text)
    if [body["kind"] for body in info["bodies"]] != ["solid"]:
        return None, 0
    planes = [face for face in info["bodies"][0]["faces"] if face["type"] == "plane"]
    if not planes:
        return None, 0
    return max(planes, key=lambda face: face["area_mm2"])["id"], info["diagonal_mm"]


def check(args: argparse.Namespace, part: Path, shell: Path, face: str, thickness: str) -> dict:
    command = [str(args.phront), "check", str(shell), "--against", str(part), "-t", thickness]
    code, text, err, _ = run([*command, "--open", face, "--report", "-"], 200)
    told = json.loads(text) if code in (0, 4) else {"reasons": err.strip().splitlines()[-1:]}
    return {"pass": code == 0, "reasons": told.get("reasons", []), "check": told}


def run_part(args: argparse.Namespace, row: dict) -> dict | None:
    part = SHARED / "corpus" / row["name"]
    face, diagonal = largest_plane(args.phront, part)
    if face is None:
        return None
    thickness = f"{args.percent / 100 * diagonal:.9g}"
    case = {"part": row["name"], "face": face, "thickness": thickness}
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "shell.step"
        command = [str(args.phront), "shell", str(part), "-o", str(out), "-t", thickness]
        report = Path(folder) / "shell.json"
        code, _, err, seconds = run(
            [*command, "--open", face, "-q", "--report", str(report)], args.limit
        )
        ours = {"exit": code, "seconds": seconds, "message": err.strip().splitlines()[-1:]}
        if report.exists():
            told = json.loads(report.read_text())
            ours["kind"] = told["bodies"][0]["kind"]
            ours["attempts"] = told["bodies"][0]["attempts"]
            ours["full"] = any("too thin" in warning for warning in told["warnings"])
        case["phront"] = ours
        if out.exists():
            ours |= check(args, part, out, face, thickness)
        theirs = Path(folder) / "thick.brep"
        code, _, _, seconds = run(
            [str(args.thick), str(part), str(theirs), face[1:], thickness], args.limit
        )
        case["occt"] = {"exit": code, "seconds": seconds, "pass": False}
        if theirs.exists():
            case["occt"] |= check(args, part, theirs, face, thickness)
    return case


def summary(cases: list[dict]) -> str:
    lines = [f"{'part':<44}{'face':>6}{'phront':>14}{'s':>7}{'OpenCASCADE':>14}{'s':>7}"]

    def word(side: dict) -> str:
        if side.get("pass"):
            return "facets" if side.get("kind") == "faceted" else "exact"
        if side["exit"] is None:
            return "hang"
        return "none" if not side.get("reasons") else "wrong"

    for case in cases:
        ours, theirs = case["phront"], case["occt"]
        lines.append(
            f"{case['part'][:43]:<44}{case['face']:>6}{word(ours):>14}{ours['seconds']:>7.1f}"
            f"{'pass' if theirs['pass'] else word(theirs):>14}{theirs['seconds']:>7.1f}"
        )
    for name in ("phront", "occt"):
        passed = sum(1 for case in cases if case[name].get("pass"))
        share = 100 * passed / max(1, len(cases))
        lines.append(f"{name}: {passed} of {len(cases)} ({share:.1f} %)")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    build = ROOT / "build" / "release"
    parser.add_argument("--phront", type=Path, default=build / "phront")
    parser.add_argument("--thick", type=Path, default=build / "phront_thick_solid")
    parser.add_argument("--out", type=Path, default=build / "corpus")
    parser.add_argument("--parts", nargs="*", default=["*"])
    parser.add_argument("--percent", type=float, default=1.0, help="wall, of the diagonal")
    parser.add_argument("--limit", type=float, default=200)
    parser.add_argument("--again", action="store_true")
    args = parser.parse_args()
    manifest = SHARED / "corpus" / "MANIFEST.csv"
    if not manifest.exists() or not args.thick.exists():
        print("SKIPPED: no corpus, or phront_thick_solid is not built")
        return SKIPPED
    args.out.mkdir(parents=True, exist_ok=True)
    results = args.out / "shells.jsonl"
    cases = {}
    if results.exists():
        for line in results.read_text().splitlines():
            case = json.loads(line)
            cases[case["part"]] = case
    with manifest.open() as file:
        rows = [
            row
            for row in csv.DictReader(file)
            if any(fnmatch.fnmatch(row["name"], p) for p in args.parts)
        ]
    chosen = []
    for row in rows:
        if args.again or row["name"] not in cases:
            case = run_part(args, row)
            if case is None:
                continue
            cases[row["name"]] = case
            with results.open("a") as file:
                file.write(json.dumps(case) + "\n")
            print(case["part"], case["phront"]["exit"], case["phront"]["message"], flush=True)
        chosen.append(cases[row["name"]])
    print(summary(chosen))
    broken = [
        case["part"]
        for case in chosen
        if case["phront"]["exit"] not in (0, 1, 3, 4)
        or (case["phront"]["exit"] == 0 and not case["phront"].get("pass"))
    ]
    for part in broken:
        print(f"PROMISE BROKEN {part}")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
