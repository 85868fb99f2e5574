#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""The scripts that compare silt with others, without the others: stand-ins take the place of all
programs. What they must refuse, what their checks must notice, and that nothing is written in the part
of a peer's run that is timed."""
import glob
import json
import math
import os
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
BENCHMARKS = os.path.join(ROOT, "benchmarks")
PEERS = os.path.join(BENCHMARKS, "peers")
sys.dont_write_bytecode = True
sys.path[:0] = [BENCHMARKS, PEERS]
import codes  # noqa: E402
import peers  # noqa: E402
import report  # noqa: E402
import shapes  # noqa: E402

# Stands in for all programs. WRONG says what goes wrong: 'NAME:what'.
STAND_IN = r'''#!/usr/bin/python3
import json, os, re, sys
name, words = os.path.basename(sys.argv[0]), sys.argv[1:]
whose, _, wrong = os.environ["WRONG"].partition(":")
wrong = wrong if whose == name else ""
N = 200

def dump(path, contacts):
    rows = N - (wrong == "loses")
    with open(path, "w") as f:
        f.write("ITEM: ATOMS id x y z radius\n")
        f.writelines(f"{k + 1} {contacts} {1 if wrong == 'stays' else 2} 0.01 0.00215\n" for k in range(rows))

if name in ("lmp", "liggghts"):
    if words == ["-h"]:
        print("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled)" if name == "liggghts" else
              "Large-scale Atomic/Molecular Massively Parallel Simulator - 29 Sep 2021")
        sys.exit()
    deck = open(words[words.index("-in") + 1]).read()
    skin = float(re.search(r"^neighbor (\S+)", deck, re.M)[1])
    seconds = 1 + abs(skin - 4e-4) * 1e3  # 0.4 mm is the fastest
    seconds -= 0.1 * ("balance 500 1.02 rcb" in deck)  # LAMMPS' balancing pays
    for _ in range(1 if wrong == "stops" else 2):
        print(f"Step Atoms KinEng\n   1 {N} 1e-6\nLoop time of {seconds} on 1 procs")
    dump(re.search(r"write_dump all custom (\S+)", deck)[1], 3 if wrong == "loosens" else 4.5)
elif name == "mpirun":
    os.execv(words[4], words[4:])
elif name in ("bench_bed", "bench_bed_ranks"):
    if words[0] in ("settle", "flow"):
        open(words[3], "w").write("bed")
    elif words[0] == "discharge":
        open(words[2], "w").write("Atoms\n\n1 1 0.0043 2500 4.5 1 0.01\n")
        w, a, low, high = 0.15, 0.045, 0.05, 0.095
        open(words[3], "w").writelines(f"vertex {x} {y} {z}\n" for x, y, z in (
            (0, 0, high), (w, 0, high), (w - a, a, low), (a, a, low)))
    elif words[0] == "time":
        print("seconds 0.1 kinetic_energy 1e-6 contacts 1 overlap 0.01 megabytes 1")
        if name == "bench_bed_ranks":
            print("percent_of_time 1.0+0.5+2.0 1.0+0.5+2.0")
        with open(words[6], "w") as f:
            f.write(f"Atoms {words[7]}\n\n" + "".join(f"{k + 1} 1 0.0043 2500 4.5 2 0.01\n" for k in range(N)))
    else:
        rows = open(words[1]).read().split("\n")[2:-1]
        print(f"spheres {len(rows)} coordination {rows[0].split()[4]} mean_overlap_over_d 0.004 "
              f"mean_height_m 0.01 out {100 * int(rows[0].split()[5])}")
elif name == "bench_search":
    filter_ = next(w for w in words if "filter" in w)
    rows = [{"name": f"search/dense bed/{search}/{n}", "items_per_second": 1e7, "pairs": 3.0,
             "sum": 6.0 if wrong == "misses" and search == "Nbs" else 5.0}
            for search in ("HashedGrid", "HashedGrid, in order", "Nbs") for n in (1000, 10000)]
    print(json.dumps({"benchmarks": rows if "dense" in filter_ else []}))
elif name == "bench_goldschmidt":
    if words[0] == "settle":
        open(words[1], "w").write("0 0 0.1\n")
    else:
        print(f"seconds 2 timed 0.9e-3 spheres {24749 if wrong == 'loses' else 24750} clipped 0 "
              f"volume_error 1e-16 momentum_error {1e-3 if wrong == 'leaks' else 1e-12}")
        open(words[5], "w").write("0.0001 2000 0.1\n0.001 2000 0.1\n")
elif name == "bench_bodies":
    if words[0] == "measure":
        print(f"bodies 1000 contacts {9 if 'x' in open(words[1]).read() else 8.4} partners 6 overlap 0.01 "
              f"height {0.03 + (1e-3 if wrong == 'rises' else 0) * ('m' in open(words[1]).read())}")
    elif words[0] == "settle":
        open(words[3], "w").write("bodies")
    else:
        print("seconds 0.1 kinetic_energy 1")
        open(words[6], "w").write(("m" if words[4] == "mixed" else "d")
                                  + ("x" if words[5] == "shared" else ""))
'''


class Tests(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.work = self.folder.name
        self.bin = os.path.join(self.work, "bin")
        os.mkdir(self.bin)
        for name in ("lmp", "liggghts", "bench_bed", "bench_bed_ranks", "mpirun", "bench_search",
                     "bench_goldschmidt", "bench_bodies", "bench_super_ellipsoids_bed", "bench_polyhedra_bed"):
            path = os.path.join(self.bin, name)
            with open(path, "w") as f:
                f.write(STAND_IN)
            os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        with open(self.work + "/matplotlib.py", "w") as f:  # no pictures: they take seconds
            f.write("raise ImportError\n")
        self.scripts = {
            "peers": [os.path.join(PEERS, "peers.py"), "--silt", self.bin + "/bench_bed",
                      "--native", self.work],
            "fluid": [os.path.join(PEERS, "fluid.py"), "--silt", self.bin + "/bench_goldschmidt"],
            "shapes": [os.path.join(PEERS, "shapes.py"), "--silt", self.bin, "--native", self.work,
                       "--cases", "bodies"],
            "search": [os.path.join(BENCHMARKS, "search", "search.py"), "--bench",
                       self.bin + "/bench_search", "--native", self.work]}

    def tearDown(self):
        self.folder.cleanup()

    def script(self, name, *arguments, wrong=""):
        return subprocess.run(["/usr/bin/python3", "-B", *self.scripts[name], *arguments],
                              capture_output=True, text=True, cwd=self.work,
                              env={"PATH": self.bin, "WRONG": wrong, "HOME": self.work,
                                   "PYTHONPATH": self.work})

    def summary_of(self, name, *arguments, status=0, wrong=""):
        done = self.script(name, "--quick", "--out", self.work + "/out", *arguments, wrong=wrong)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        with open(self.work + "/out/summary.json") as f:
            found = json.load(f)
        for part in ("inputs", "versions", "results", "checks"):
            self.assertTrue(found[part], part)
        self.assertIn("processor", found["versions"])
        self.assertEqual(all(check["holds"] for check in found["checks"]), status == 0)
        return found

    def failing(self, name, *arguments, wrong):
        found = self.summary_of(name, *arguments, status=1, wrong=wrong)
        return [check["name"] for check in found["checks"] if not check["holds"]]

    def test_refuses_with_one_sentence(self):
        open(self.work + "/file", "w").close()
        for name, script in self.scripts.items():
            for words, arguments in (("nonsense", ["--nonsense"]), ("0", ["--repeat", "0"]),
                                     ("many", ["--repeat", "many"]),
                                     ("file/out", ["--quick", "--out", self.work + "/file/out"]),
                                     ("nowhere", [script[1], "/nowhere"])):
                done = self.script(name, *arguments)
                self.assertEqual(done.returncode, 2, (name, arguments, done.stderr))
                self.assertEqual(len(done.stderr.splitlines()), 1, (name, done.stderr))
                self.assertIn(words, done.stderr)
        self.assertEqual(self.script("peers", "--work", "nan").returncode, 2)
        self.assertEqual(self.script("peers", "12").returncode, 2)
        done = self.script("peers", "--silt-avx2", "/nowhere")
        self.assertEqual((done.returncode, "/nowhere" in done.stderr), (2, True))

    def test_peers(self):
        found = self.summary_of("peers", "200", "--states", "settled", "--skins", "0.6", "0.4")
        scene = found["results"]["scenes"][0]
        self.assertEqual(scene["skins"]["LAMMPS, Debian"]["mm"], 0.4)  # the faster of both
        self.assertIn("LIGGGHTS-PUBLIC 3.8.0", found["versions"]["LIGGGHTS, Debian"])
        self.assertEqual(scene["speed"]["silt double"]["runs"], 2)
        self.assertTrue(os.path.exists(self.work + "/out/table.txt"))

    def test_peers_flow_under_the_same_gravity(self):
        found = self.summary_of("peers", "200", "--states", "flowing")
        self.assertEqual(found["results"]["scenes"][0]["state"], "flowing")
        for program in ("lmp", "liggghts"):
            with open(f"{self.work}/out/{program}.in") as f:
                self.assertIn("gravity 9.81 vector 0.70710678 0 -0.70710678\n", f.read())
        with open(self.work + "/out/silt.end") as f:
            self.assertIn("tilted", f.readline())

    def test_peers_on_two_processes_with_balancing_where_it_pays(self):
        found = self.summary_of("peers", "200", "--states", "settled", "--cores", "2", "--silt-ranks",
                                self.bin + "/bench_bed_ranks")
        scene = found["results"]["scenes"][0]
        self.assertTrue(scene["skins"]["LAMMPS, Debian"]["balanced"])
        self.assertFalse(scene["skins"]["LIGGGHTS, Debian"]["balanced"])
        with open(self.work + "/out/lmp.in") as f:
            self.assertIn("fix b all balance 500 1.02 rcb\n", f.read())
        with open(self.work + "/out/liggghts.in") as f:
            self.assertNotIn("balance", f.read())
        self.assertIn("silt double, ranks", scene["speed"])
        self.assertIn("silt mixed", scene["speed"])

    def test_native_peers_and_ranks_on_two_processes(self):
        os.symlink(self.bin + "/lmp", self.work + "/lmp")
        os.symlink(self.bin + "/liggghts", self.work + "/liggghts")
        found = self.summary_of("peers", "200", "--states", "hopper", "--cores", "2", "--silt-ranks",
                                self.bin + "/bench_bed_ranks")
        scene = found["results"]["scenes"][0]
        self.assertTrue(scene["skins"]["LAMMPS, native"]["balanced"])
        for name in ("LAMMPS, native", "LIGGGHTS, native", "silt double, ranks", "silt mixed, ranks"):
            self.assertIn(name, scene["speed"])

    def test_peers_have_the_same_hopper(self):
        found = self.summary_of("peers", "200", "--states", "hopper")
        self.assertEqual(found["results"]["scenes"][0]["ends"]["silt double"]["left"], 100)
        with open(self.work + "/out/silt.end") as f:
            self.assertIn("hopper", f.readline())
        with open(self.work + "/out/lmp.in") as f:
            deck = f.read()
        # Slabs from the orifice at 0.05 m, 0.045 m from the box, to the box at 0.095 m.
        slabs = [[float(word) for word in line.split()[3:12]] for line in deck.splitlines()
                 if line.startswith("region ")]
        self.assertEqual(len(slabs), 4)
        for (a, b), (c, d), (low, high), tilts in ([s[0:2], s[2:4], s[4:6], s[6:9]] for s in slabs):
            self.assertEqual((low, high), (0.05, 0.095))
            along, across, tilt = ((a, b), (c, d), tilts[1]) if tilts[1] else ((c, d), (a, b), tilts[2])
            self.assertEqual(across, (0, 0.15))
            face = along[1] if tilt < 0 else along[0]
            self.assertAlmostEqual(face, 0.045 if tilt < 0 else 0.105)
            self.assertAlmostEqual(face + tilt, 0 if tilt < 0 else 0.15)
        self.assertEqual(sorted(s[7] + 2 * s[8] for s in slabs), [-0.09, -0.045, 0.045, 0.09])
        self.assertEqual(deck.count("wall/gran/region"), 4)
        with open(self.work + "/out/liggghts.in") as f:
            self.assertIn("hopper.200.stl", f.read())

    def test_peers_notices_a_hopper_that_does_not_empty(self):
        self.assertEqual(self.failing("peers", "200", "--states", "hopper", wrong="lmp:stays"),
                         ["200 spheres, hopper, 1 core, LAMMPS, Debian: spheres that left the hopper"])

    def test_peers_notices_lost_spheres_and_contacts(self):
        self.assertIn("200 spheres, settled, 1 core, LAMMPS, Debian: spheres",
                      self.failing("peers", "200", "--states", "settled", wrong="lmp:loses"))
        self.assertIn("200 spheres, settled, 1 core, LIGGGHTS, Debian: contacts a sphere",
                      self.failing("peers", "200", "--states", "settled", wrong="liggghts:loosens"))

    def test_peers_refuses_a_peer_that_stops(self):
        done = self.script("peers", "200", "--quick", wrong="lmp:stops")
        self.assertEqual(done.returncode, 2)
        self.assertIn("did not finish", done.stderr)

    def test_native_peers_are_timed_as_well(self):
        os.symlink(self.bin + "/lmp", self.work + "/lmp")
        with open(self.work + "/lmp.flags", "w") as f:
            f.write("-O3 -march=native")
        found = self.summary_of("peers", "200", "--states", "settled")
        self.assertIn("-O3 -march=native", found["versions"]["LAMMPS, native"])
        self.assertIn("LAMMPS, native", found["results"]["scenes"][0]["speed"])

    def test_search_notices_other_pairs(self):
        self.summary_of("search", "--alone")
        self.assertEqual(self.failing("search", "--alone", wrong="bench_search:misses"),
                         [f"dense bed, {n}: searches of 3 that find other pairs (Nbs)"
                          for n in (1000, 10000)])

    def test_fluid_notices_losses(self):
        self.summary_of("fluid")
        self.assertEqual(len(self.failing("fluid", wrong="bench_goldschmidt:loses")), 3)
        self.assertEqual(len(self.failing("fluid", wrong="bench_goldschmidt:leaks")), 3)

    def test_shapes_notices_another_end(self):
        os.remove(self.bin + "/liggghts")
        self.summary_of("shapes")
        self.assertTrue(self.failing("shapes", wrong="bench_bodies:rises"))

    def test_decks_write_nothing_in_what_is_timed(self):
        decks = {"LAMMPS": peers.LAMMPS, "LIGGGHTS": peers.LIGGGHTS,
                 "superquadrics": shapes.deck("liggghts_superquadrics.in").format(
                     box="", particles="", skin=1, task=shapes.TIME),
                 "bodies": shapes.deck("liggghts_bodies.in")}
        for name, deck in decks.items():
            lines = [line for line in deck.splitlines() if line.strip()]
            runs = [k for k, line in enumerate(lines) if line.startswith("run ")]
            self.assertEqual(len(runs), 2, name)  # to warm up, and timed
            for line in lines[:runs[-1]]:
                self.assertFalse(line.split()[0] in ("dump", "restart"), f"{name}: {line}")
            self.assertTrue(lines[runs[-1] + 1].startswith("write_dump"), name)
        self.assertIn("writeInterval {every}", codes_of("fluid.py"))

    def test_decks_leave_one_layer_of_processors(self):
        for deck in (peers.LAMMPS, peers.LIGGGHTS):  # halves of a bed, not floor and top
            self.assertIn("processors * * 1", deck)

    def test_lammps_has_the_restitution_of_the_others(self):
        # Each start of a run puts the walls' restitution through Tsuji's polynomial once more: with two
        # of them walls rebounded with 0.6. And the polynomial counts on the mass of one sphere.
        starts = [line for line in peers.LAMMPS.splitlines()
                  if line.startswith("run ") and not line.endswith("pre no")]
        self.assertEqual(len(starts), 1)
        e = float(peers.LAW.split()[2])
        tsuji = (1.2728 - 4.2783 * e + 11.087 * e**2 - 22.348 * e**3 + 27.467 * e**4 - 18.022 * e**5
                 + 4.8218 * e**6)
        exact = math.log(2) * math.sqrt(5) / math.hypot(math.log(2), math.pi)  # rebounds with 0.5
        self.assertAlmostEqual(tsuji, exact, places=4)

    def test_digits_are_no_finer_than_the_spread(self):
        self.assertEqual(report.rounded(46.42, 0.9), "46")
        self.assertEqual(report.rounded(46.42, 0.3), "46.4")
        self.assertEqual(report.rounded(46.42, 7), "50")
        self.assertEqual(report.rounded(46.42, 0), "46")
        self.assertEqual(report.rounded(0.0021349, 0.0002), "0.0021")
        self.assertEqual(report.rounded(37621, 300), "37600")
        self.assertEqual(report.rounded(3.0, 1e-9), "3.000")
        fast, slow = report.Speed([40, 46, 50]), report.Speed([6.4, 6.5, 6.6])
        self.assertEqual(fast.text(), "50")
        self.assertEqual(slow.spread(), "(6.4 to 6.6)")
        self.assertEqual(fast.over(slow), "7")
        self.assertEqual(report.Speed([6.4]).spread(), "(one run)")

    def test_summary_fails_without_checks_or_with_no_number(self):
        summary = report.Summary({}, {})
        self.assertFalse(summary.all_hold())
        summary.at_most("one", 1, 2)
        self.assertTrue(summary.all_hold())
        summary.at_most("two", math.nan, 2)
        self.assertFalse(summary.all_hold())
        summary.write(self.work)
        with open(self.work + "/summary.json") as f:
            self.assertNotIn("NaN", f.read())

    def test_processor(self):
        path = self.work + "/cpuinfo"
        with open(path, "w") as f:
            f.write("processor\t: 0\ncpu family\t: 26\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n"
                    "flags\t\t: sse2 avx2 avx512f\n\nprocessor\t: 1\nmodel name\t: another\n")
        self.assertEqual(report.processor(path), "AMD EPYC, family 26 model 2, AVX-512")
        self.assertEqual(report.processor("/nowhere"), "unknown processor")

    def test_fastest_setting(self):
        self.assertEqual(codes.fastest([3, 1, 2], lambda s: s)[0], 1)
        self.assertEqual(codes.fastest([3], None), (3, {}))

    def test_scripts_parse(self):
        for path in glob.glob(BENCHMARKS + "/**/*.py", recursive=True):
            with open(path) as f:
                compile(f.read(), path, "exec")


def codes_of(name):
    with open(os.path.join(PEERS, name)) as f:
        return f.read()


if __name__ == "__main__":
    unittest.main()
