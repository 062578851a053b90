#!/usr/bin/env bash
# Installs what is missing, builds phront, makes the sample bracket, offsets it by +2 mm and -1 mm
# and hollows it, draws all and checks them. Everything it makes lies in samples/out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/packages.sh

installMissingPackages
buildRelease phront make_bracket phront_picture

phront=build/release/phront
out=samples/out
mkdir -p "$out"

echo "== the sample part"
build/release/make_bracket "$out/bracket.step"

# offsetAndCheck DISTANCE NAME: the offset as STEP, with a picture, judged once more from the file.
offsetAndCheck() {
  echo "== offset by $1 mm"
  "$phront" offset "$out/bracket.step" -d "$1" -o "$out/$2.step" --picture "$out/$2.png"
  echo "== is $2.step the offset of bracket.step at $1 mm?"
  "$phront" check "$out/$2.step" --against "$out/bracket.step" -d "$1"
}
offsetAndCheck 2 bracket_plus2
offsetAndCheck -1 bracket_minus1

echo "== hollow, 1.5 mm of wall, the upright's front open"
"$phront" shell "$out/bracket.step" -t 1.5 --open F3 -o "$out/bracket_shell.step" \
  --picture "$out/bracket_shell.png"
echo "== is bracket_shell.step that shell of bracket.step?"
"$phront" check "$out/bracket_shell.step" --against "$out/bracket.step" -t 1.5 --open F3

echo
echo "part     $out/bracket.step"
echo "results  $out/bracket_plus2.step  $out/bracket_minus1.step  $out/bracket_shell.step"
echo "pictures $out/bracket_plus2.png  $out/bracket_minus1.png  $out/bracket_shell.png"
