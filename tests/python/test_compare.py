# silt - BSD-3-Clause, see LICENSE
"""`silt compare` and `silt info`."""

import json
import os
import shutil
import tempfile
import unittest

import numpy as np
import silt
from scenes import Refuses, has, needs, path, run, run_apart
from test_readers import write_vtp


class Compare(Refuses, unittest.TestCase):
    def test_the_same_run_twice_is_equal(self):
        done = run_apart("compare", path("grains"), path("again"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"all \d+ are equal")
        for name in ("particles.pvd", "contacts.pvd", "bonds.pvd", "walls.pvd", "energy.csv"):
            self.assertIn(name + ":", done.stdout)

    def test_another_gravity_differs_where_it_must(self):
        done = run_apart("compare", path("grains", "particles.pvd"), path("other", "particles.pvd"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("FAIL  velocity [m/s]", done.stdout)
        found = {one.name: one for one in silt.compare(path("grains", "particles.pvd"), path("other", "particles.pvd"))}
        a, b = (silt.open(path(name, "particles.pvd")) for name in ("grains", "other"))
        apart = [np.abs(x["velocity"][x.find(y.ids)].astype(float) - y["velocity"]) for x, y in zip(a, b)]
        self.assertEqual(found["velocity"].largest, max(d.max() for d in apart))
        self.assertAlmostEqual(found["velocity"].rms, np.sqrt(np.mean(np.concatenate(apart) ** 2)), delta=1e-12)
        self.assertEqual(found["velocity"].unit, "m/s")
        self.assertRegex(found["velocity"].where, r"t = 0\.0\d+ s, particle \d+")
        self.assertEqual(found["radius"].largest, 0)
        wide = 1.01 * max(one.relative for one in found.values())
        self.assertEqual(run("compare", path("grains", "particles.pvd"), path("other", "particles.pvd"),
                             "--tolerance", wide).returncode, 0)
        only = run("compare", path("grains", "particles.pvd"), path("other", "particles.pvd"), "--fields", "radius,id")
        self.assertEqual(only.returncode, 0)
        self.assertIn("all 2 are equal", only.stdout)

    @needs("pieces")
    def test_ranks_are_matched_by_id(self):
        done = run("compare", path("whole", "particles.pvd"), path("pieces", "particles.pvd"), "--tolerance", 1e-6)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_one_value_that_differs_is_found(self):
        """Catches differences that cancel, of another particle, nan taken for equal."""
        with tempfile.TemporaryDirectory() as folder:
            a, b = (os.path.join(folder, name + ".vtp") for name in "ab")
            ids = np.array([7, 3, 9], np.uint64)
            mass = np.array([1.0, 2.0, 4.0])
            write_vtp(a, np.zeros((3, 3)), {"id": ids, "mass [kg]": mass})
            order = [2, 0, 1]
            write_vtp(b, np.zeros((3, 3)), {"id": ids[order], "mass [kg]": (mass + [0, 0.5, 0])[order]})
            found = {one.name: one for one in silt.compare(a, b)}["mass"]
            self.assertEqual((found.largest, found.scale, found.relative, found.where), (0.5, 4, 0.125, "particle 3"))
            self.assertTrue(found.exceeds(0.12) and not found.exceeds(0.13) and not found.exceeds(0, 0.5))
            write_vtp(b, np.zeros((3, 3)), {"id": ids, "mass [kg]": np.array([1, np.nan, 4])})
            self.assertEqual(silt.compare(a, b)[-1].largest, np.inf)
            self.assertEqual(run("compare", a, b, "--tolerance", 1e9).returncode, 1)
            write_vtp(a, np.zeros((3, 3)), {"id": ids, "mass [kg]": np.array([1, np.nan, 4])})
            self.assertEqual(silt.compare(a, b)[-1].largest, 0)
            big = np.array([2**63, 2**63 + 1], np.uint64)  # beyond what a double tells apart
            write_vtp(a, np.zeros((2, 3)), {"n": big})
            write_vtp(b, np.zeros((2, 3)), {"n": big + np.uint64(1)})
            self.assertGreaterEqual(silt.compare(a, b, ["n"])[0].largest, 1)
            write_vtp(b, np.zeros((3, 3)), {"id": ids + np.uint64(1), "mass [kg]": mass})
            write_vtp(a, np.zeros((3, 3)), {"id": ids, "mass [kg]": mass})
            self.raises("other particles: id 3 in A where B has 4", silt.compare, a, b)
            write_vtp(b, np.zeros((3, 3)), {"id": ids, "heat": mass})
            self.raises("the field 'heat' is in one of them alone", silt.compare, a, b)
            write_vtp(b, np.zeros((2, 3)), {"id": ids[:2], "mass [kg]": mass[:2]})
            self.raises("A has 3 points and B has 2", silt.compare, a, b)

    def test_tables_and_summaries(self):
        with tempfile.TemporaryDirectory() as folder:
            def csv(name, content):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(content)
                return os.path.join(folder, name)

            a = csv("a.csv", "id,x [m]\n1,0.5\n2,0.25\n")
            b = csv("b.csv", "id,x [m]\n2,0.25\n1,0.75\n")
            found = silt.compare(a, b)[-1]
            self.assertEqual((found.name, found.unit, found.largest, found.relative), ("x", "m", 0.25, 1 / 3))
            self.raises("A has 2 rows and B has 1", silt.compare, a, csv("c.csv", "id,x [m]\n1,1\n"))
            big = [csv(f"{k}.csv", f"id,x [m]\n{2**63 + k},{k}\n{2**63 + 1},1\n") for k in (2, 3)]
            found = silt.compare(*big, common=True)  # beyond what a double tells apart
            self.assertEqual([(one.count, one.largest) for one in found], [(1, 0), (1, 0)])
            self.raises("is in one of them alone", silt.compare, a, csv("c.csv", "id,y [m]\n1,1\n2,2\n"))
            self.raises("there is no field or column 'z'", silt.compare, a, b, ["z"])

            def summary(name, value, seconds):
                with open(os.path.join(folder, name), "w") as file:
                    json.dump({"results": {"mass [kg]": value, "seconds": seconds}, "checks": []}, file)
                return os.path.join(folder, name)

            one, two = summary("a.json", 2.0, 10), summary("b.json", 2.0, 12)
            self.assertEqual(run("compare", one, two).returncode, 1)
            done = run("compare", one, two, "--ignore", "seconds")
            self.assertEqual((done.returncode, "all 1 are equal" in done.stdout), (0, True), done.stdout)
            self.raises("are of different kinds", silt.compare, a, one)

    def test_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(path("grains"), os.path.join(folder, "a"))
            os.remove(os.path.join(folder, "a", "energy.csv"))
            self.raises("has 'energy.csv'", silt.compare, os.path.join(folder, "a"), path("grains"))
            self.raises("is a folder; compare two folders or two files", silt.compare, folder, path("grains", "energy.csv"))
            self.raises("there is no file or folder", silt.compare, folder, os.path.join(folder, "b"))
            empty = tempfile.mkdtemp(dir=folder)
            self.raises("have no series, tables or summaries", silt.compare, empty, empty)
        self.refused("must not be negative", "compare", path("grains"), path("again"), "--tolerance", -1)
        self.refused("cannot be read", "compare", path("grains", "energy.csv"), path("no.csv"))
        self.raises("A has 3 frames and B has 1", silt.compare, path("grains", "particles.pvd"),
                    silt.open(path("grains", "particles.pvd")).files[0])


    def test_runs_of_different_length(self):
        """--common: times, rows and files of both, and words for the rest. Catches frames paired by
        number: every second frame of a copy must be equal."""
        with tempfile.TemporaryDirectory() as folder:
            a, b = (os.path.join(folder, name) for name in "ab")
            for name in (a, b):
                shutil.copytree(path("grains"), name)
            with open(os.path.join(b, "particles.pvd")) as file:
                lines = [line for line in file if 'timestep="0"' not in line]
            with open(os.path.join(b, "particles.pvd"), "w") as file:
                file.writelines(lines)
            with open(os.path.join(b, "energy.csv")) as file:
                rows = file.readlines()
            with open(os.path.join(b, "energy.csv"), "w") as file:
                file.writelines(rows[:1] + rows[2:])
            os.remove(os.path.join(b, "walls.pvd"))
            for name in os.listdir(b):
                if name.startswith("walls_"):
                    os.remove(os.path.join(b, name))
            self.refused("A has 3 frames and B has 2; --common", "compare", os.path.join(a, "particles.pvd"),
                         os.path.join(b, "particles.pvd"))
            done = run("compare", a, b)
            self.assertEqual(done.returncode, 2)
            for words in ("A has 3 frames and B has 2", "A has 5 rows and B has 4", "has 'walls.pvd'"):
                self.assertIn(words, done.stderr, "folders must go on after the first file")
            self.assertEqual((done.stderr.count("\n"), done.stderr.count("--common")), (1, 1))
            self.assertIn("bonds.pvd:", done.stdout)
            done = run("compare", a, b, "--common")
            self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
            for words in ("are equal", "left out: particles.pvd: 1 of 3 frames of A and 0 of 2 of B",
                          "energy.csv: 1 of 5 rows of A and 0 of 4", "left out: the files ", "walls.pvd"):
                self.assertIn(words, done.stdout)
            one, two = (os.path.join(folder, name + ".vtp") for name in "ab")
            ids, mass = np.array([7, 3, 9], np.uint64), np.array([1.0, 2.0, 4.0])
            write_vtp(one, np.zeros((3, 3)), {"id": ids, "mass [kg]": mass})
            write_vtp(two, np.zeros((2, 3)), {"id": ids[1:], "mass [kg]": mass[1:] + [0, 1], "heat": mass[1:]})
            done = run("compare", one, two, "--common")
            self.assertEqual(done.returncode, 1)
            self.assertIn("1 of 3 particles of A and 0 of 2 of B", done.stdout)
            self.assertIn("the fields heat", done.stdout)
            found = {d.name: d for d in silt.compare(one, two, common=True)}["mass"]
            self.assertEqual((found.largest, found.where, found.count), (1, "particle 9", 2))
            self.raises("A has 120 points of a surface", silt.compare, *(silt.Frame(silt.sources.ArraySource(
                "x", "surface", ["wall"], {"field/wall": np.zeros(n)})) for n in (120, 7)))
            write_vtp(two, np.zeros((2, 3)), {"mass [kg]": mass[1:]})
            write_vtp(one, np.zeros((3, 3)), {"mass [kg]": mass})
            self.raises("A has 3 points and B has 2", silt.compare, one, two, common=True)

    def test_objects_instead_of_paths(self):
        name, other = path("grains", "particles.pvd"), path("other", "particles.pvd")
        a, b = silt.open(name), silt.open(other)
        self.assertEqual(silt.compare(a, b), silt.compare(name, other))
        self.assertEqual(silt.compare(a[1:], b[1:])[0].largest, silt.compare(name, b)[0].largest)
        self.assertTrue(all(one.largest == 0 for one in silt.compare(a[::2], name, common=True)))
        self.raises("A has 2 frames and B has 3; --common (in Python common=True)", silt.compare, a[::2], name)
        self.assertEqual(silt.compare(a[-1], a[-1])[0].largest, 0)
        self.assertGreater(silt.compare(a[0], a[-1], ["position"])[0].largest, 0)
        energy = silt.table(path("grains", "energy.csv"))
        self.assertEqual(silt.compare(energy, path("grains", "energy.csv"))[0].largest, 0)
        self.raises("'%s' is a Series" % name, silt.compare, a, energy)
        self.raises("takes paths, Series", silt.compare, 3, a)
        self.raises("no time or step in common", silt.compare, a[:1], a[1:], common=True)


class Info(Refuses, unittest.TestCase):
    def test_what_is_in_files(self):
        for arguments, words in (
                (("grains", "particles.pvd"), ["3 frames, t = 0 to 0.0", "120 particles", "velocity [m/s]", "3 components",
                                               "temperature [K]"]),
                (("pieces", "particles.pvd"), ["27 particles", "by 3 ranks"]),
                (("grains", "contacts.pvd"), ["contacts", "normal_force [N]"]),
                (("grains", "bonds.pvd"), ["bonds", "load [-]"]),
                (("grains", "walls.pvd"), ["points of a surface with", "wall"]),
                (("shapes", "surfaces.pvd"), ["of 18 bodies"]),
                (("flow", "flow.pvd"), ["60 cells, 4 x 3 x 5 of 0.001 x 0.002 x 0.001 m", "pressure [Pa]"]),
                (("grains", "energy.csv"), ["a table of 5 rows", "kinetic energy [J]"]),
                (("failed", "failure.txt"), ["particles named:"]),
                (("failed",), ["particles.csv: 1 rows", "last_good.silt: a checkpoint", "failure.txt:"]),
                (("grains",), ["particles.pvd: 3 frames", "energy.csv: 5 rows", "half.silt: a checkpoint"])):
            if not has(arguments[0]):
                continue
            done = run("info", path(*arguments))
            self.assertEqual((done.returncode, done.stderr), (0, ""), arguments)
            for word in words:
                self.assertIn(word, done.stdout, arguments)
        self.refused("cannot be read", "info", path("nothing"))

    def test_ranges_are_those_of_the_file(self):
        words = run("info", path("flow", "flow.pvd")).stdout
        pressure = silt.open(path("flow", "flow.pvd"))[-1]["pressure"]
        self.assertIn(f"{pressure.min():.6g} to {pressure.max():.6g}", words)


if __name__ == "__main__":
    unittest.main()
