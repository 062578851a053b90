#!/usr/bin/env python3
"""The phront executable as its user meets it: exit codes, sentences, files, same bits.

Environment: PHRONT the executable, MAKE_BRACKET the generator of the sample part.
"""

import json
import math
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

PHRONT = os.environ["PHRONT"]
MAKE_BRACKET = os.environ["MAKE_BRACKET"]
LIMIT = 300


def phront(*args: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        [PHRONT, *map(str, args)], capture_output=True, text=True, timeout=LIMIT, check=False
    )


def write_box_stl(path: Path, size: float) -> None:
    corners = [(x, y, z) for z in (0, size) for y in (0, size) for x in (0, size)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    facets = [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
    with path.open("wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", len(facets)))
        for facet in facets:
            file.write(struct.pack("<3f", 0, 0, 0))
            for corner in facet:
                file.write(struct.pack("<3f", *corners[corner]))
            file.write(b"\0\0")


class CliTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.part = cls.folder / "bracket.step"
        subprocess.run([MAKE_BRACKET, str(cls.part)], check=True, timeout=LIMIT)
        cls.box = cls.folder / "box.stl"
        write_box_stl(cls.box, 10)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.temporary.cleanup()

    def out(self, name: str) -> Path:
        path = self.folder / name
        path.unlink(missing_ok=True)
        return path

    def test_surfaces(self) -> None:
        for distance, name in ((1, "skins.step"), (-1, "skins.iges")):
            out, report = self.out(name), self.out("skins.json")
            done = phront(
                "offset", self.part, f"--distance={distance}", "--surfaces", "-o", out,
                "--report", report,
            )  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("22 trimmed surfaces from 22 faces: 22 exact", done.stderr)
            data = json.loads(report.read_text())
            self.assertEqual(data["failed"], 0)
            self.assertLessEqual(data["deviation_mm"], data["tolerance_mm"])
            back = phront("info", out, "-q", "--report", "-")
            bodies = json.loads(back.stdout)["bodies"]
            self.assertEqual(sum(len(body["faces"]) for body in bodies), 22)

    def test_surfaces_of_what_has_none(self) -> None:
        done = phront("offset", self.box, "-d", 1, "--surfaces", "-o", self.folder / "skins.step")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--surfaces", done.stderr)
        out = self.out("none.step")
        done = phront("offset", self.part, "--distance=-30", "--surfaces", "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("there is no offset", done.stderr)
        self.assertFalse(out.exists())

    def test_drawing_in_drawing_out(self) -> None:
        drawing = self.folder / "plate.svg"
        drawing.write_text(
            '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="30mm" '
            'viewBox="0 0 40 30"><rect width="40" height="30"/><circle cx="20" cy="15" r="6"/></svg>'
        )
        report = self.out("plate.json")
        out = self.out("plate_plus2.dxf")
        run = phront("offset", drawing, "-o", out, "-d", 2, "--report", report)
        self.assertEqual(run.returncode, 0, run.stderr)
        told = json.loads(report.read_text())
        self.assertEqual((told["loops_in"], told["curves_out"]), (2, 2))
        self.assertLessEqual(told["deviation_mm"], 0.002)
        self.assertIn("POLYLINE", out.read_text())
        gone = self.out("plate_minus12.svg")
        run = phront("offset", drawing, "-o", gone, "-d", -12)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("empty", run.stderr)
        self.assertFalse(gone.exists())
        run = phront("offset", drawing, "-o", out, "-d", 2, "--parametric")
        self.assertEqual(run.returncode, 2)
        run = phront("offset", drawing, "-o", self.out("plate.step"), "-d", 2)
        self.assertEqual(run.returncode, 2)
        self.assert_one_sentence(run)

    def assert_one_sentence(self, run: subprocess.CompletedProcess) -> None:
        lines = [line for line in run.stderr.splitlines() if line.startswith("phront: ")]
        self.assertEqual(len(lines), 1, run.stderr)

    # --- wrong usage: exit 2

    def test_zero_nan_and_nonsense_distances_are_usage_errors(self) -> None:
        for distance in ("0", "0mm", "nan", "inf", "abc", "2parsec", ""):
            out = self.out("usage.step")
            run = phront("offset", self.part, "-o", out, "-d", distance)
            self.assertEqual(run.returncode, 2, distance + run.stderr)
            self.assertFalse(out.exists())

    def test_shell_is_made_told_and_checked(self) -> None:
        out = self.out("shell.step")
        report = self.out("shell.json")
        run = phront(
            "shell", self.part, "-t", "1.5", "--open", "F3", "-o", out, "--report", report
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("measured thickness 1.5 mm", run.stderr)
        told = json.loads(report.read_text())
        self.assertEqual(told["open_faces"], 1)
        self.assertLess(told["check"]["accuracy_p99_mm"], 1e-6)
        against = ("check", out, "--against", self.part)
        self.assertEqual(phront(*against, "-t", "1.5", "--open", "F3").returncode, 0)
        self.assertEqual(phront(*against, "-t", "1.6", "--open", "F3").returncode, 4)
        self.assertEqual(phront(*against, "-t", "1.5").returncode, 4)
        self.assertEqual(phront(*against, "-t", "1.5", "-d", "1").returncode, 2)
        self.assertEqual(phront(*against).returncode, 2)

    def test_shell_refusals_say_why_and_write_nothing(self) -> None:
        out = self.out("none.step")
        for arguments, code, word in (
            (("-t", "0"), 2, "positive"),
            (("-t", "1", "--open", "F99"), 2, "F99"),
            (("-t", "1", "--open", "lid"), 2, "normal:+z"),
            (("-t", "1", "--open", "F6"), 1, "not planar"),
            (("-t", "1", "--side", "up"), 2, "up"),
        ):
            run = phront("shell", self.part, "-o", out, *arguments)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(word, run.stderr)
            self.assertFalse(out.exists())

    def test_unknown_output_extension_is_named(self) -> None:
        run = phront("offset", self.part, "-o", self.out("a.xyz"), "-d", "1")
        self.assertEqual(run.returncode, 2)
        self.assertIn("xyz", run.stderr)

    def test_output_equal_to_input_is_refused_and_input_untouched(self) -> None:
        before = self.part.read_bytes()
        run = phront("offset", self.part, "-o", self.part, "-d", "1")
        self.assertEqual(run.returncode, 2)
        self.assertEqual(self.part.read_bytes(), before)

    def test_no_command_and_unknown_option(self) -> None:
        self.assertEqual(phront().returncode, 2)
        self.assertEqual(phront("offset", "--what").returncode, 2)
        self.assertEqual(phront("--version").returncode, 0)
        self.assertEqual(phront("offset", "-h").returncode, 0)

    # --- unreadable input: exit 3

    def test_missing_folder_empty_and_garbage_inputs(self) -> None:
        empty = self.folder / "empty.step"
        empty.touch()
        garbage = self.folder / "garbage.step"
        garbage.write_bytes(bytes(range(256)) * 20)
        for bad in (self.folder / "none.step", self.folder, empty, garbage):
            out = self.out("bad.step")
            run = phront("offset", bad, "-o", out, "-d", "1")
            self.assertEqual(run.returncode, 3, f"{bad}: {run.stderr}")
            self.assert_one_sentence(run)
            self.assertFalse(out.exists())

    def test_unwritable_output_is_told_before_the_work(self) -> None:
        run = phront("offset", self.part, "-o", self.folder / "nowhere" / "a.step", "-d", "1")
        self.assertEqual(run.returncode, 1)
        self.assert_one_sentence(run)

    @unittest.skipUnless(Path("/dev/full").exists(), "needs /dev/full")
    def test_full_disk_is_an_error(self) -> None:
        run = phront("info", self.part, "-q", "--report", "/dev/full")
        self.assertEqual(run.returncode, 1, run.stderr)

    # --- the main job

    def test_offset_of_the_bracket_is_valid_and_measured(self) -> None:
        out = self.out("plus.step")
        report = self.folder / "plus.json"
        run = phront("offset", self.part, "-o", out, "-d", "0.04in", "--report", report, "-v")
        self.assertEqual(run.returncode, 0, run.stderr)
        told = json.loads(report.read_text())
        self.assertAlmostEqual(told["distance_mm"], 1.016)
        self.assertTrue(told["check"]["pass"])
        self.assertGreaterEqual(told["check"]["solids"], 1)
        self.assertLess(told["check"]["accuracy_p99_mm"], 0.01016)
        self.assertIn("measured deviation", run.stderr)
        again = phront("check", out, "--against", self.part, "-d", "0.04in")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        wrong = phront("check", out, "--against", self.part, "-d", "1.2")
        self.assertEqual(wrong.returncode, 4)
        self.assertIn("FAIL", wrong.stdout)

    def test_mitre_is_sharp_and_told(self) -> None:
        out = self.out("mitre.step")
        report = self.out("mitre.json")
        run = phront(
            "offset", self.part, "-o", out, "-d", "1", "--join", "mitre", "--report", report
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        told = json.loads(report.read_text())
        self.assertEqual(told["join"], "mitre")
        self.assertEqual(told["bodies"][0]["rounded_faces"], 0)
        self.assertEqual(told["check"]["faces"], told["bodies"][0]["input_faces"])
        against = ("check", out, "--against", self.part, "-d", "1")
        self.assertEqual(phront(*against, "--join", "mitre").returncode, 0)
        self.assertEqual(phront(*against).returncode, 4)
        mesh = self.out("mitre.stl")
        run = phront("offset", self.part, "-o", mesh, "-d", "1", "--join", "mitre")
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertFalse(mesh.exists())

    def test_faces_have_a_distance_of_their_own(self) -> None:
        out = self.out("own.step")
        report = self.out("own.json")
        own = ("--distance-of", "F13=1.5", "--distance-of", "normal:-z=0")
        run = phront("offset", self.part, "-o", out, "-d", "1", *own, "--report", report)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(json.loads(report.read_text())["distance_of"], list(own[1::2]))
        against = ("check", out, "--against", self.part, "-d", "1")
        self.assertEqual(phront(*against, *own).returncode, 0)
        self.assertEqual(phront(*against).returncode, 4)
        for term, word in (
            ("normal:+z", "F3=2"),
            ("F99=1", "F99"),
            ("normal:+z=", "length"),
            ("F13=50", "cannot be moved"),
        ):
            none = self.out("none.step")
            run = phront("offset", self.part, "-o", none, "-d", "1", "--distance-of", term)
            self.assertNotEqual(run.returncode, 0, term)
            self.assertIn(word, run.stderr)
            self.assertFalse(none.exists())
        mesh = self.out("own.stl")
        run = phront("offset", self.part, "-o", mesh, "-d", "1", *own)
        self.assertEqual(run.returncode, 2, run.stderr)

    def test_walls_have_a_thickness_of_their_own(self) -> None:
        out = self.out("own_shell.step")
        shell = ("-t", "1.5", "--open", "normal:+z", "--distance-of", "normal:-z=3")
        run = phront("shell", self.part, "-o", out, *shell)
        self.assertEqual(run.returncode, 0, run.stderr)
        against = ("check", out, "--against", self.part)
        self.assertEqual(phront(*against, *shell).returncode, 0)
        self.assertEqual(phront(*against, *shell[:4]).returncode, 4)
        self.assertEqual(phront(*against, *shell, "--join", "mitre").returncode, 2)

    def test_thinner_than_twice_d_is_empty_and_done(self) -> None:
        out = self.out("none_left.step")
        run = phront("offset", self.part, "-o", out, "-d", "-500")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("offset is empty", run.stderr)
        self.assertFalse(out.exists())

    def test_info_lists_faces(self) -> None:
        run = phront("info", self.part, "-v")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("F1 ", run.stdout)
        self.assertIn("solid", run.stdout)

    def test_field_is_written(self) -> None:
        out = self.out("field.vtu")
        run = phront("field", self.box, "-o", out, "--spacing", "1", "--band", "2")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn(b"VTKFile", out.read_bytes()[:200])

    # --- meshes

    def test_turned_triangle_is_mended_with_a_warning(self) -> None:
        data = bytearray(self.box.read_bytes())
        at = 84 + 50 * 4 + 12  # the corners of facet 4
        data[at + 12 : at + 36] = data[at + 24 : at + 36] + data[at + 12 : at + 24]
        turned = self.folder / "turned.stl"
        turned.write_bytes(data)
        for command in (("field", "--spacing", "1"), ("offset", "-d", "1")):
            outputs = []
            for source in (self.box, turned):
                out = self.out("turned.vtu" if command[0] == "field" else "turned_offset.stl")
                run = phront(command[0], source, "-o", out, *command[1:])
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertEqual("1 triangle(s) disagreed" in run.stderr, source == turned)
                outputs.append(out.read_bytes())
            self.assertEqual(outputs[0], outputs[1])

    def test_same_bits_at_any_thread_count(self) -> None:
        for source in (self.part, self.box):
            outputs = []
            for threads in (1, 2):
                out = self.out(f"threads{threads}.stl")
                run = phront("offset", source, "-o", out, "-d", "1.5", "--threads", threads)
                self.assertEqual(run.returncode, 0, run.stderr)
                outputs.append(out.read_bytes())
            self.assertGreater(len(outputs[0]), 84)
            self.assertEqual(outputs[0], outputs[1])

    def test_parametric_keeps_connectivity_and_order(self) -> None:
        out = self.out("parametric.stl")
        run = phront("offset", self.box, "-o", out, "-d", "-1", "--parametric")
        self.assertEqual(run.returncode, 0, run.stderr)
        data = out.read_bytes()
        self.assertEqual(struct.unpack_from("<I", data, 80)[0], 12)
        original = self.box.read_bytes()
        for facet in range(12):
            for corner in range(3):
                at = 84 + 50 * facet + 12 + 12 * corner
                new = struct.unpack_from("<3f", data, at)
                old = struct.unpack_from("<3f", original, at)
                for n, o in zip(new, old):  # each corner moved by 1 inwards along all three axes
                    self.assertTrue(math.isclose(n, 1 if o == 0 else 9, abs_tol=1e-5), (n, o))

    def test_mesh_in_gives_no_solid_out(self) -> None:
        run = phront("offset", self.box, "-o", self.out("a.step"), "-d", "1")
        self.assertEqual(run.returncode, 2)


if __name__ == "__main__":
    unittest.main()
