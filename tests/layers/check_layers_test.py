#!/usr/bin/env python3
"""The check of the layers finds what it is made for: each violation, put into a small tree, is told."""

import tempfile
import unittest
from pathlib import Path

import check_layers

GOOD = {
    "kernel/include/phront/types.h": "#include <Eigen/Core>\n",
    "kernel/src/base/parallel.h": '#include "phront/types.h"\n',
    "kernel/src/front/march.cpp": '#include <gp_Pnt.hxx>\n#include "base/parallel.h"\n',
    "kernel/src/io/stl.cpp": '#include "front/march.h"\n',
    "cad/include/phront/cad/shape.h": '#include "phront/types.h"\n',
    "cad/include/phront/cad/shape_occt.h": "#include <TopoDS_Shape.hxx>\n",
    "cad/src/exchange/guard.h": "#include <string>\n",
    "cad/src/exchange/read.cpp": '#include <TopoDS.hxx>\n#include "exchange/guard.h"\n',
    "cad/cli/cli.h": "#include <string>\n",
    "cad/cli/main.cpp": '#include "cli.h"\n#include "phront/cad/shape.h"\n',
}

BAD = [
    ("kernel/src/base/low.cpp", '#include "geom/bvh.h"'),
    ("kernel/src/field/low.cpp", '  #  include "io/stl.h"'),
    ("kernel/src/layers/low.cpp", "#include <io/stl.h>"),
    ("kernel/src/geom/topology.cpp", "#include <TopoDS_Shape.hxx>"),
    ("kernel/src/geom/topology.cpp", "#include <BRep_Tool.hxx>"),
    ("kernel/src/io/cad.cpp", '#include "phront/cad/shape.h"'),
    ("kernel/src/geom/sideways.cpp", '#include "../io/stl.h"'),
    ("kernel/src/stray/x.cpp", "#include <string>"),
    ("kernel/include/phront/bad.h", '#include "base/parallel.h"'),
    ("kernel/include/phront/bad.h", "#include <gp_Pnt.hxx>"),
    ("cad/include/phront/cad/bad.h", "#include <TopoDS_Shape.hxx>"),
    ("cad/src/rebuild/bad.cpp", '#include "base/parallel.h"'),
    ("cad/src/rebuild/bad.cpp", '#include "geom/not_there_yet.h"'),
    ("cad/src/rebuild/bad.cpp", '#include "../../../kernel/src/base/parallel.h"'),
    ("cad/cli/bad.cpp", '#include "exchange/guard.h"'),
    ("cad/cli/bad.cpp", '#include "phront/cad/shape_occt.h"'),
    ("cad/cli/bad.cpp", "#include <BRep_Builder.hxx>"),
]


def write(root: Path, name: str, text: str) -> None:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


class CheckLayersTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        for name, text in GOOD.items():
            write(self.root, name, text)

    def test_good_tree_passes(self) -> None:
        self.assertEqual(check_layers.violations(self.root), [])

    def test_each_violation_is_told_with_its_place(self) -> None:
        for name, line in BAD:
            with self.subTest(name=name, line=line):
                write(self.root, name, "// a comment\n" + line + "\n")
                found = check_layers.violations(self.root)
                self.assertEqual(len(found), 1, found)
                self.assertTrue(found[0].startswith(name + ":"), found)
                (self.root / name).unlink()

    def test_commented_include_is_no_include(self) -> None:
        write(self.root, "kernel/src/base/low.cpp", '// #include "geom/bvh.h"\n')
        self.assertEqual(check_layers.violations(self.root), [])


if __name__ == "__main__":
    unittest.main()
