#!/usr/bin/env python3
"""Includes go down only.

kernel: base < geom < nurbs < field < front < layers < io; no topology of OpenCASCADE.
cad:    of the kernel only its public headers (phront/*.h).
cli, python, freecad, samples: public headers only.
Public headers: public headers only; OpenCASCADE in phront/cad/shape_occt.h alone.

Usage: check_layers.py SOURCE_FOLDER; prints each violation, exit 1 if there is any.
"""

import re
import sys
from pathlib import Path

LAYERS = ["base", "geom", "nurbs", "field", "front", "layers", "io"]
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
# OpenCASCADE headers are Package_Class.hxx or Package.hxx; the kernel may see pure geometry only:
# these packages of TKernel, TKMath, TKG2d and TKG3d.
OCCT = re.compile(r"^([A-Za-z0-9]+)(_\w+)?\.(hxx|lxx|gxx)$")
PURE_GEOMETRY = {
    "gp", "math", "BSplCLib", "BSplSLib", "BSpline", "PLib", "ElCLib", "ElSLib", "CSLib", "Bnd",
    "Precision", "Standard", "NCollection", "TColgp", "TColStd", "TColGeom", "TColGeom2d", "Geom",
    "Geom2d", "GeomAdaptor", "Geom2dAdaptor", "Adaptor2d", "Adaptor3d", "GeomAbs", "GeomEvaluator",
    "Geom2dEvaluator", "GeomLProp", "LProp", "GProp", "BVH", "TopLoc",
}  # fmt: skip


def sources(folder: Path):
    if folder.is_dir():
        for path in sorted(folder.rglob("*")):
            if path.suffix in {".h", ".hpp", ".cpp", ".cc", ".cxx", ".inc"}:
                yield path


def includes(path: Path):
    """(line, header, quoted) of each include."""
    text = path.read_text(encoding="utf-8", errors="replace")
    for match in INCLUDE.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, match[2], match[1] == '"'


def occt_package(header: str) -> str | None:
    match = OCCT.match(header)
    return match[1] if match else None


def kernel_include(layer: str, header: str, path: Path, source: Path) -> str | None:
    package = occt_package(header)
    if package is not None:
        return None if package in PURE_GEOMETRY else "the kernel must not see OpenCASCADE's topology"
    if header.startswith("phront/cad/"):
        return "the kernel must not see cad"
    if header.startswith("phront/"):
        return None
    first = header.split("/")[0]
    if ".." in header.split("/"):
        return "includes by .. are not allowed"
    if first in LAYERS and "/" in header and LAYERS.index(first) > LAYERS.index(layer):
        return f"{layer} must not include the higher layer {first}"
    return None


def check_kernel(root: Path):
    source = root / "kernel" / "src"
    for path in sources(source):
        layer = path.relative_to(source).parts[0]
        if layer not in LAYERS:
            yield path, 1, f"{layer} is none of the layers {' < '.join(LAYERS)}"
            continue
        for line, header, _ in includes(path):
            if trouble := kernel_include(layer, header, path, source):
                yield path, line, f"{header}: {trouble}"


def check_public(root: Path):
    for part in ("kernel", "cad"):
        folder = root / part / "include"
        for path in sources(folder):
            inside = path.relative_to(folder).as_posix()
            for line, header, quoted in includes(path):
                if occt_package(header) and inside != "phront/cad/shape_occt.h":
                    yield path, line, f"{header}: OpenCASCADE in a public header"
                elif part == "kernel" and header.startswith("phront/cad/"):
                    yield path, line, f"{header}: the kernel must not see cad"
                elif quoted and not header.startswith("phront/"):
                    yield path, line, f"{header}: a private header in a public one"


def check_cad(root: Path):
    kernel = root / "kernel" / "src"
    private = {p.relative_to(kernel).as_posix() for p in sources(kernel) if p.suffix != ".cpp"}
    own = root / "cad" / "src"
    for path in sources(own):
        for line, header, _ in includes(path):
            if ".." in header.split("/"):
                yield path, line, f"{header}: includes by .. are not allowed"
            elif header in private and not (own / header).exists():
                yield path, line, f"{header}: cad must see the kernel's public headers only"
            elif header.split("/")[0] in LAYERS and "/" in header and not (own / header).exists():
                yield path, line, f"{header}: cad must see the kernel's public headers only"


def check_users(root: Path):
    for folder in (root / "cad" / "cli", root / "cad" / "python", root / "cad" / "freecad"):
        for path in sources(folder):
            for line, header, quoted in includes(path):
                if occt_package(header) or header == "phront/cad/shape_occt.h":
                    yield path, line, f"{header}: only public headers without OpenCASCADE here"
                elif quoted and not header.startswith("phront/") and not (path.parent / header).exists():
                    yield path, line, f"{header}: only public headers here"
                elif ".." in header.split("/"):
                    yield path, line, f"{header}: includes by .. are not allowed"


def violations(root: Path) -> list[str]:
    found = []
    for check in (check_kernel, check_public, check_cad, check_users):
        for path, line, text in check(root):
            found.append(f"{path.relative_to(root)}:{line}: {text}")
    return found


def main() -> int:
    root = Path(sys.argv[1]).resolve()
    count = sum(1 for part in ("kernel", "cad") for _ in sources(root / part))
    if count < 2:
        print(f"{root}: no sources found")
        return 1
    found = violations(root)
    print("\n".join(found) if found else f"{count} files: includes go down only")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
