#!/usr/bin/env bash
# Builds the benchmarks with their peers (OpenVDB, ITK) and runs them on one idle machine: the speeds
# and their ratios, the methods of the thesis side by side, the growth of a band with the grid.
# Arguments go to Google Benchmark, e.g. tests/bench/run.sh --benchmark_filter=sweep
# PHRONT_BENCH_PARTS names further parts (STEP, IGES, BREP), split by colons.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source tests/packages.sh

packages+=(libbenchmark-dev libopenvdb-dev libinsighttoolkit5-dev)
installMissingPackages
buildRelease make_bracket
echo "== building the benchmarks"
cmake --preset release -DPHRONT_BENCHMARKS=ON
cmake --build --preset release --parallel "$(nproc)" \
  --target phront_bench phront_methods phront_growth phront_nurbs_bench

out=samples/out/bench
mkdir -p "$out"
build/release/make_bracket "$out/bracket.step"
export PHRONT_BENCH_PARTS="$out/bracket.step${PHRONT_BENCH_PARTS:+:$PHRONT_BENCH_PARTS}"
build/release/phront_bench "$@"
build/release/phront_methods
echo
build/release/phront_growth "$out/growth.svg"
echo "plot: $out/growth.svg"
