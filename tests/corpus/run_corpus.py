#!/usr/bin/env python3
"""Offsets every corpus part at several distances and lets the independent judge decide.

    tests/corpus/run_corpus.py                      # all parts, all distances, both cores
    tests/corpus/run_corpus.py --parts 'thor__*' --percent 2 -2
    tests/corpus/run_corpus.py --summary            # the table of what has been run

Results are appended to <out>/results.jsonl, one line a case; a case that is there is not run again
(--again runs it anew), so a stopped run goes on where it was. Distances are percent of the part's
bounding-box diagonal. Exit: 0, or 1 when a case broke a promise (a crash, a hang, or exit code 0 on a
result that the judge fails); 77 when the corpus or the judge is not there.
"""

import argparse
import concurrent.futures
import csv
import fnmatch
import hashlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
SKIPPED = 77
PERCENT = [-5.0, -2.0, -0.5, 0.5, 2.0, 5.0]


def run(command: list[str], limit: float) -> tuple[int | None, str, str, float]:
    """Exit code (None: ran past the limit), standard output, standard error, seconds."""
    start = time.monotonic()
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        out, err = process.communicate(timeout=limit)
        code: int | None = process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        out, err = process.communicate()
        code = None
    return code, out, err, time.monotonic() - start


def build_judge(folder: Path) -> Path:
    """The judge is no part of the project: it is built from where it lies, once."""
    judge = folder / "judge_offset"
    if not judge.exists():
        for step in (
            ["cmake", "-S", str(SHARED / "judge"), "-B", str(folder), "-DCMAKE_BUILD_TYPE=Release"],
            ["cmake", "--build", str(folder), "--target", "judge_offset"],
        ):
            subprocess.run(step, check=True, stdout=subprocess.DEVNULL)
    return judge


def judge_case(judge: Path, part: Path, out: str, distance: float, limit: float) -> dict:
    code, text, _, seconds = run(
        [str(judge), str(part), out, "--distance", repr(distance), "--json"], limit
    )
    try:
        verdict = json.loads(text)
    except json.JSONDecodeError:
        verdict = {"reasons": ["judge timed out" if code is None else f"judge ended with {code}"]}
    return {
        "pass": code == 0,
        "reasons": verdict.get("reasons", []),
        "valid": verdict.get("out_valid", False),
        "closed": verdict.get("out_closed", False),
        "side": verdict.get("side_ok", -1),
        "in_solids": verdict.get("in_solids", 0),
        "out_faces": verdict.get("out_faces", 0),
        "truly_empty": verdict.get("true_offset_empty", False),
        "p99_rel": verdict.get("acc_p99_rel"),
        "seconds": seconds,
    }


def run_case(args: argparse.Namespace, judge: Path, row: dict, percent: float) -> dict:
    part = SHARED / "corpus" / row["name"]
    distance = float(f"{percent / 100 * float(row['diag_mm']):.9g}")
    out = args.out / f"{row['name']}_{percent:+g}.step"
    rejected = out.with_suffix(".rejected.step")
    report = out.with_suffix(".json")
    for stale in (out, rejected, report):
        stale.unlink(missing_ok=True)
    command = [str(args.phront), "offset", str(part), "-o", str(out), "-d", repr(distance)]
    command += ["--threads", str(args.threads), "--report", str(report), "-q"]
    code, _, err, seconds = run(command, args.limit)
    case = {"part": row["name"], "percent": percent, "distance": distance, "exit": code}
    case |= {"seconds": round(seconds, 2), "message": err.strip().splitlines()[-1:]}
    if report.exists():
        told = json.loads(report.read_text())
        case["kinds"] = sorted({body["kind"] for body in told["bodies"]})
        case["exact_faces"] = sum(body["exact_faces"] for body in told["bodies"])
        case["faceted_faces"] = sum(body["faceted_faces"] for body in told["bodies"])
        case["attempts"] = [line for body in told["bodies"] for line in body["attempts"]]
        case["stages"] = told["seconds"]
    written = out if out.exists() else rejected if rejected.exists() else None
    case["rejected"] = written == rejected and written is not None
    if written:
        case["judge"] = judge_case(judge, part, str(written), distance, args.judge_limit)
    elif code == 0:
        case["judge"] = judge_case(judge, part, "EMPTY", distance, args.judge_limit)
    else:  # nothing to judge, but whether the part is a solid must be known
        judged = judge_case(judge, part, "EMPTY", distance, args.judge_limit)
        case["judge"] = judged | {"pass": False, "reasons": ["no file"]}
    return case


def passes(case: dict) -> bool:
    return case["exit"] == 0 and case["judge"]["pass"]


def sound(case: dict) -> bool:
    """A valid closed solid on the right side, or a rightly empty result, accepted or not."""
    judged = case["judge"]
    if judged.get("truly_empty") and judged["pass"]:
        return True
    return judged["valid"] and judged["closed"] and judged.get("side", 0) >= 0.999


def promise_broken(case: dict) -> str:
    code = case["exit"]
    if code is None:
        return "hang"
    if code < 0 or code not in (0, 1, 2, 3, 4):
        return f"crash (exit {code})"
    if code == 0 and not case["judge"]["pass"]:
        return "exit 0, judge fails: " + "; ".join(case["judge"]["reasons"])
    return ""


def mark(case: dict | None) -> str:
    """One character a case: what the table shows."""
    if case is None:
        return " "
    if promise_broken(case):
        return "!"
    if passes(case):
        kinds = case.get("kinds", [])
        return "f" if "faceted" in kinds else "e" if kinds == ["empty"] else "+"
    return "r" if sound(case) else "-"


def summary(rows: list[dict], cases: dict[tuple[str, float], dict], percents: list[float]) -> str:
    lines = [
        "+ passes, exact   f passes, some facets   e passes, rightly empty",
        "r rejected but a valid closed solid   - no valid solid   ! promise broken",
        f"{'part':<48}" + "".join(f"{p:>+7g}%" for p in percents) + "   slowest",
    ]
    for row in rows:
        mine = [cases.get((row["name"], p)) for p in percents]
        slowest = max((c["seconds"] for c in mine if c), default=0)
        lines.append(
            f"{row['name'][:47]:<48}"
            + "".join(f"{mark(c):>8}" for c in mine)
            + f"{slowest:>9.1f}s"
        )
    names = {row["name"] for row in rows}
    done = [c for c in cases.values() if c["part"] in names and c["percent"] in percents]

    def share(chosen: list[dict], test) -> str:
        count = sum(1 for c in chosen if test(c))
        return f"{count}/{len(chosen)} ({100 * count / max(1, len(chosen)):.1f} %)"

    columns = [[c for c in done if c["percent"] == p] for p in percents]
    lines.append(
        f"{'passes':<48}" + "".join(f"{sum(map(passes, c)):>4}/{len(c):<3}" for c in columns)
    )
    solid = [c for c in done if c["judge"].get("in_solids", 0) > 0]
    exact = [c for c in done if passes(c) and "faceted" not in c.get("kinds", [])]
    lines.append(f"passes: {share(done, passes)}; without a facet: {len(exact)}")
    lines.append(f"solid parts: valid, closed, right side or rightly empty: {share(solid, sound)}")
    seconds = sorted(c["seconds"] for c in done) or [0.0]
    lines.append(f"seconds a case: median {seconds[len(seconds) // 2]:.1f}, most {seconds[-1]:.1f}")
    broken = [(c, promise_broken(c)) for c in done if promise_broken(c)]
    lines += [f"PROMISE BROKEN {c['part']} {c['percent']:+g} %: {why}" for c, why in broken]
    return "\n".join(lines)


def load(path: Path) -> dict[tuple[str, float], dict]:
    cases = {}
    if path.exists():
        for line in path.read_text().splitlines():
            case = json.loads(line)
            cases[(case["part"], case["percent"])] = case
    return cases


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--phront", type=Path, default=ROOT / "build/release/phront")
    parser.add_argument("--out", type=Path, default=ROOT / "build/corpus")
    parser.add_argument("--parts", nargs="*", default=["*"], help="name patterns")
    parser.add_argument("--percent", nargs="*", type=float, default=PERCENT)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--threads", type=int, default=1, help="of each phront")
    parser.add_argument("--limit", type=float, default=120, help="seconds a case")
    parser.add_argument("--judge-limit", type=float, default=300, help="seconds a verdict")
    parser.add_argument("--again", action="store_true", help="run cases that are there already")
    parser.add_argument("--summary", action="store_true", help="only print the table")
    args = parser.parse_args()

    manifest = SHARED / "corpus" / "MANIFEST.csv"
    if not manifest.exists():
        print("SKIPPED: no corpus beside the project")
        return SKIPPED
    with manifest.open(newline="") as file:
        rows = [
            row
            for row in csv.DictReader(file)
            if any(fnmatch.fnmatch(row["name"], pattern) for pattern in args.parts)
        ]
    args.out.mkdir(parents=True, exist_ok=True)
    results = args.out / "results.jsonl"
    cases = load(results)
    if not args.summary:
        judge = build_judge(args.out / "judge")
        todo = [
            (row, percent)
            for percent in args.percent
            for row in rows
            if args.again or (row["name"], percent) not in cases
        ]
        # Scattered, the same way every time: a run that is stopped is an even sample.
        todo.sort(key=lambda item: hashlib.md5(f"{item[0]['name']} {item[1]:+g}".encode()).digest())
        lock = threading.Lock()

        def work(item: tuple[dict, float]) -> None:
            case = run_case(args, judge, *item)
            with lock:
                cases[(case["part"], case["percent"])] = case
                with results.open("a") as file:
                    file.write(json.dumps(case) + "\n")
                print(
                    f"[{mark(case)}] {case['part']} {case['percent']:+g} % {case['seconds']:.1f} s "
                    + "; ".join(case["judge"]["reasons"]),
                    flush=True,
                )

        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            list(pool.map(work, todo))
    print(summary(rows, cases, args.percent))
    chosen = {row["name"] for row in rows}
    return int(
        any(promise_broken(c) for k, c in cases.items() if k[0] in chosen and k[1] in args.percent)
    )


if __name__ == "__main__":
    sys.exit(main())
