#!/usr/bin/env bash
# Installs what is missing, builds phront (release) and runs all its tests.
# The last line counts them; the exit status is 0 only if none failed.
# Extra arguments go to ctest, e.g. tests/run.sh -L unit
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/packages.sh

installMissingPackages
buildRelease

echo "== testing"
log=build/release/ctest.log
status=0
ctest --preset release --parallel "$(nproc)" "$@" 2>&1 | tee "$log" || status=$?

# ctest's own per-test lines: "12/40 Test #12: name ....   Passed    0.10 sec".
count() { grep -cE "^ *[0-9]+/[0-9]+ +Test +#[0-9]+: .*$1" "$log" || true; }
all=$(count "")
passed=$(count " Passed +[0-9.]+ sec")
skipped=$(count "\*\*\*(Skipped|Not Run \(Disabled\))")
failed=$((all - passed - skipped))
if ((all == 0)); then
  echo "no test was run" >&2
  status=1
fi
if ((failed > 0 && status == 0)); then status=1; fi
echo "$passed passed, $failed failed, $skipped skipped"
exit "$status"
