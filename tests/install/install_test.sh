#!/usr/bin/env bash
# Installs a build into a new prefix, moves that prefix, and builds and runs a consumer from there: with
# CMake and with pkg-config.
# Usage: install_test.sh BUILD_FOLDER CMAKE CXX_COMPILER yes|no (was cad built?)
set -euo pipefail
build=$1 cmake=$2 cxx=$3 cad=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

expect() {  # expect WANTED COMMAND...: the command prints just that
  local wanted=$1 got
  shift
  got=$("$@")
  [[ "$got" == "$wanted" ]] || { echo "$*: \"$got\" instead of \"$wanted\"" >&2; exit 1; }
  echo "$*: $got"
}
readonly phi="phi -0.5 2" refused="cad refused"

"$cmake" --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/prefix"
if grep -rIl "$work/first" "$work/prefix"; then
  echo "these files name the folder they were installed to" >&2
  exit 1
fi

echo "== CMake"
"$cmake" -S "$here/consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_BUILD_TYPE=Release >/dev/null
"$cmake" --build "$work/consumer" >/dev/null
expect "$phi" "$work/consumer/consumer"
[[ $cad == no ]] || expect "$refused" "$work/consumer/cad_consumer"
# A major version that is not there must not be found.
mkdir "$work/greedy"
printf 'cmake_minimum_required(VERSION 3.25)\nproject(greedy LANGUAGES CXX)\nfind_package(phront 99)\n%s\n' \
  'if(phront_FOUND OR NOT phront_CONSIDERED_VERSIONS)
  message(FATAL_ERROR "found ${phront_VERSION}")
endif()' >"$work/greedy/CMakeLists.txt"
"$cmake" -S "$work/greedy" -B "$work/greedy/build" -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCMAKE_CXX_COMPILER="$cxx" >/dev/null 2>&1 || { echo "version 99 was found" >&2; exit 1; }

if ! command -v pkg-config >/dev/null; then
  echo "pkg-config is not there: that way is not tested"
  exit 0
fi
echo "== pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name phront.pc)")
export PKG_CONFIG_PATH
read -ra kernelFlags <<<"$(pkg-config --cflags --libs phront-kernel)"
"$cxx" -std=c++20 "$here/consumer/consumer.cpp" "${kernelFlags[@]}" -o "$work/by_pkg_config"
expect "$phi" "$work/by_pkg_config"
if [[ $cad == yes ]]; then
  read -ra allFlags <<<"$(pkg-config --cflags --libs phront)"
  "$cxx" -std=c++20 "$here/consumer/cad_consumer.cpp" "${allFlags[@]}" -o "$work/cad_by_pkg_config"
  expect "$refused" "$work/cad_by_pkg_config"
fi
