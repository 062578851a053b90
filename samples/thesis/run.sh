#!/usr/bin/env bash
# Builds and runs the cases of the thesis, all or those named. Tables go to the terminal, figures
# (PNG) and data (CSV, VTU) to samples/out/thesis/CASE.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source tests/packages.sh

installMissingPackages
buildRelease thesis phront_picture

cases=("$@")
if ((${#cases[@]} == 0)); then
  cases=(point_in_square sphere cube loops cascade heat_exchanger corner circle_inward cube_inward
    carotid)
fi
for case in "${cases[@]}"; do
  folder="samples/out/thesis/$case"
  echo
  "build/release/thesis_$case" "$folder"
  echo "files: $folder"
done
