# silt - BSD-3-Clause, see LICENSE
"""Readers against tables of the same step, closed forms, and files that are not whole."""

import base64
import json
import math
import os
import shutil
import struct
import tempfile
import unittest
import zlib

import numpy as np
import silt
from scenes import Refuses, has, needs, path


class Particles(Refuses, unittest.TestCase):
    def test_fields_are_those_of_the_table_of_the_same_step(self):
        series = silt.open(path("grains", "particles.pvd"))
        self.assertEqual(len(series), 3)
        np.testing.assert_allclose(series.times, [0, 0.04, 0.08], atol=1e-4)
        for frame in series:
            table = silt.table(path("grains", f"particles_{frame.step:09d}.csv"))
            at = frame.find(table["id"])
            self.assertEqual(len(table), len(frame))
            self.assertTrue((frame.ids[at] == table["id"]).all())
            for name, columns, digits in (("position", ("x", "y", "z"), 1e-15),
                                          ("velocity", ("velocity x", "velocity y", "velocity z"), 1e-6),
                                          ("temperature", ("temperature [K]",), 1e-15)):
                expected = np.stack([table[c] for c in columns], axis=1).squeeze()
                np.testing.assert_allclose(frame[name][at], expected, rtol=0,
                                           atol=digits * max(np.abs(expected).max(), 1e-30), err_msg=name)
            np.testing.assert_allclose(frame["radius"][at], table["radius"], rtol=1e-7)

    def test_names_and_units(self):
        frame = silt.open(path("grains"))[-1]  # of several series particles.pvd
        self.assertEqual(frame.fields, ("radius", "velocity", "id", "material", "angular_velocity",
                                        "temperature [K]"))
        self.assertEqual([frame.unit(n) for n in ("velocity", "|velocity|", "velocity.z", "temperature", "id", "position")],
                         ["m/s", "m/s", "m/s", "K", "", "m"])
        np.testing.assert_array_equal(frame["temperature"], frame["temperature [K]"])
        np.testing.assert_array_equal(frame["velocity.z"], frame["velocity"][:, 2])
        np.testing.assert_allclose(frame["|velocity|"], np.sqrt((frame["velocity"] ** 2).sum(axis=1)))
        np.testing.assert_array_equal(frame["z"], frame["position"][:, 2])
        self.assertEqual(frame["position"].shape, (len(frame), 3))
        self.assertEqual(frame.ids.dtype, np.uint64)
        self.assertIn("velocity", frame)
        self.assertNotIn("charge", frame)
        with self.assertRaises(ValueError):  # what is read stays what the file has
            frame["velocity"][0] = 1

    def test_a_particle_through_time(self):
        series = silt.open(path("grains", "particles.pvd"))
        # The table of each step is read by itself; particle 7 is taken out at the end.
        expected = [[t[c][t["id"] == 5][0] for c in ("velocity x", "velocity y", "velocity z")] for t in
                    (silt.table(path("grains", f"particles_{step:09d}.csv")) for step in series.steps)]
        times, values = series.track(5, "velocity")
        np.testing.assert_array_equal(times, series.times)
        np.testing.assert_allclose(values, expected, rtol=1e-6, atol=1e-9)
        self.assertEqual(series.track([5, 9], "|velocity|").values.shape, (3, 2))
        self.assertEqual(series.track([5, 9], "position").values.shape, (3, 2, 3))
        self.raises("no particle with the id 4000", series.track, 4000, "velocity")
        self.raises("has no field 'charge'; it has: radius, velocity", series.track, 5, "charge")

    def test_a_particle_that_is_not_there_is_nan(self):
        with tempfile.TemporaryDirectory() as folder:
            for step, ids in ((0, [1, 2]), (1, [2])):
                write_vtp(os.path.join(folder, f"p_{step}.vtp"), np.zeros((len(ids), 3)), {
                    "id": np.array(ids, np.uint64), "mass [kg]": np.array(ids, float)})
            values = silt.open(os.path.join(folder, "p_*.vtp")).track(1, "mass").values
            self.assertEqual(values[0], 1)
            self.assertTrue(math.isnan(values[1]))

    def test_a_pattern_is_in_the_order_of_steps_not_of_letters(self):
        with tempfile.TemporaryDirectory() as folder:
            for step in (1, 2, 10, 11):
                write_vtp(os.path.join(folder, f"w{step}.vtp"), np.full((1, 3), float(step)), {
                    "id": np.array([1], np.uint64)})
            series = silt.open(os.path.join(folder, "w*.vtp"))
            self.assertEqual(series.steps, [1, 2, 10, 11])

    def test_series_are_lazy_and_sliced(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(path("grains"), folder, dirs_exist_ok=True)
            series = silt.open(os.path.join(folder, "particles.pvd"))
            os.remove(series.files[1])  # a frame that nobody asks for
            self.assertEqual(len(series[-1]), len(series[0]))
            self.assertEqual(len(series[::2]), 2)
            self.assertEqual(series[::2][1].step, series[2].step)
            self.assertEqual(series.at(0.07).step, series.steps[2])
            self.raises("which is not there; copy all files", lambda: series[1]["velocity"])
            with self.assertRaisesRegex(silt.Error, "the time is nan"):
                series.at(math.nan)
            with self.assertRaises(silt.Error):
                series[len(series)]
            with self.assertRaises(IndexError):
                series[3]

    def test_files_alone(self):
        series = silt.open(path("grains", "particles_*.vtp"))
        self.assertEqual(len(series), 3)
        self.assertEqual(series.steps, sorted(series.steps))
        np.testing.assert_allclose(series.times, silt.open(path("grains", "particles.pvd")).times)
        frame = silt.read(series.files[1])
        self.assertEqual(frame.step, series.steps[1])
        self.assertAlmostEqual(frame.time, 0.04, delta=1e-4)


class OtherKinds(Refuses, unittest.TestCase):
    def test_contacts_are_those_of_the_table(self):
        frame = silt.open(path("grains", "contacts.pvd"))[-1]
        table = silt.table(path("grains", f"contacts_{frame.step:09d}.csv"))
        self.assertGreater(len(frame), 50)
        self.assertEqual(len(frame), len(table))
        key = np.lexsort([frame["wall"], frame["b"], frame["a"]])
        # A table has -1 where a contact has no partner, a file the largest number.
        b = np.where(table["b"] < 0, np.uint64(2**64 - 1), table["b"].astype(np.uint64))
        rows = np.lexsort([table["wall"], b, table["a"]])
        np.testing.assert_array_equal(frame["a"][key], table["a"][rows])
        np.testing.assert_array_equal(frame["wall"][key], table["wall"][rows])
        for name in ("normal_force", "overlap"):
            expected = table[name.replace("_", " ")][rows]
            scale = np.abs(expected).max()
            # Several contacts of one pair with a wall may stand in either order: sums are compared.
            np.testing.assert_allclose(np.sort(frame[name]), np.sort(expected), rtol=0, atol=1e-6 * scale)
        particles = silt.open(path("grains", "particles.pvd"))[-1]
        to = particles["position"][particles.find(frame["a"])]
        np.testing.assert_allclose(frame.lines[:, 1], to, atol=1e-8)  # lines end at a; stored as floats
        self.assertEqual(frame.unit("overlap"), "m")
        self.raises("has no ids: it has lines", lambda: frame.ids)

    def test_bonds(self):
        frame = silt.open(path("grains", "bonds.pvd"))[0]
        particles = silt.open(path("grains", "particles.pvd"))[0]
        self.assertGreater(len(frame), 5)
        ends = [particles["position"][particles.find(frame[end])] for end in ("a", "b")]
        middle = 0.5 * (ends[0] + ends[1])
        np.testing.assert_allclose(frame["position"], middle, atol=1e-8)

    def test_walls(self):
        series = silt.open(path("grains", "walls.pvd"))
        first, last = series[0], series[-1]
        self.assertEqual(first.kind, "surface")
        self.assertEqual(set(np.unique(first["wall"])), {0, 1})
        shelf = first.points[np.unique(first.wall(1))]
        np.testing.assert_allclose([shelf.min(axis=0), shelf.max(axis=0)],
                                   [[0.004, 0.002, 0.004], [0.008, 0.010, 0.004]], atol=1e-12)
        rise = last.points[np.unique(last.wall(1))][0, 2] - 0.004
        self.assertAlmostEqual(rise, 0.02 * last.time, delta=1e-5)  # [m] by its motion, a step's length
        area = np.linalg.norm(np.cross(*(first.points[first.wall(1)][:, k] - first.points[first.wall(1)][:, 0]
                                         for k in (1, 2))), axis=1).sum() / 2
        self.assertAlmostEqual(area, 0.004 * 0.008, delta=1e-12)

    def test_flow(self):
        series = silt.open(path("flow", "flow.pvd"))
        frame = series[2]
        self.assertEqual(frame.kind, "grid")
        self.assertEqual(frame.grid.cells, (4, 3, 5))
        x, y, z = (frame["position"][..., k] for k in range(3))
        np.testing.assert_allclose(frame["pressure"], x + 10 * y + 100 * z, rtol=1e-12)
        np.testing.assert_allclose(frame["velocity"], 0.5 * np.stack([z, x, y], axis=-1), rtol=1e-12)
        np.testing.assert_allclose(frame["velocity.y"], 0.5 * x, rtol=1e-12)
        np.testing.assert_allclose(frame.grid.centres(1), [1e-3, 3e-3, 5e-3])
        np.testing.assert_allclose(frame.grid.edges(0), [1e-3, 2e-3, 3e-3, 4e-3, 5e-3])
        self.assertEqual(frame["open"][3, 0, 4], 0)
        self.assertEqual(frame["open"].sum(), 57)

    @needs("shapes")
    def test_surfaces_and_parts_have_the_ids_of_their_bodies(self):
        particles = silt.open(path("shapes", "particles.pvd"))[-1]
        surfaces = silt.open(path("shapes", "surfaces.pvd"))[-1]
        self.assertEqual(set(surfaces.ids), set(particles.ids))
        self.assertEqual(set(np.unique(surfaces["form"])), {0, 1, 2})
        # Every point of a body lies within its bounding sphere.
        at = particles.find(surfaces.ids)
        away = np.linalg.norm(surfaces.points - particles["position"][at], axis=1)
        self.assertTrue((away <= 1.0001 * particles["radius"][at]).all())
        parts = silt.open(path("parts", "parts.pvd"))[-1]
        self.assertEqual(len(parts), 40)
        rods = silt.open(path("parts", "particles.pvd"))[-1]
        away = np.linalg.norm(parts.points - rods["position"][rods.find(parts.ids)], axis=1)
        np.testing.assert_allclose(away, 1e-3, rtol=1e-5)  # as the form says

    @needs("pieces")
    def test_pieces_of_ranks_are_one_frame(self):
        whole, pieces = (silt.open(path(name, "particles.pvd")) for name in ("whole", "pieces"))
        self.assertTrue(pieces.files[0].endswith(".pvtp"))
        for one, many in zip(whole, pieces):
            self.assertEqual((many.ranks, len(many), one.ranks), (3, 27, 1))
            self.assertEqual(set(np.unique(many.rank)), {0, 1, 2})
            np.testing.assert_allclose(many["position"][many.find(one.ids)], one["position"], atol=1e-12)
        contacts = [silt.open(path(name, "contacts.pvd"))[-1] for name in ("whole", "pieces")]
        np.testing.assert_allclose(*(np.sort(c["normal_force"]) for c in contacts), rtol=1e-6)
        np.testing.assert_allclose(*(np.sort(c.lines[:, 1, 0]) for c in contacts), atol=1e-7)

    @needs("pieces")
    def test_a_piece_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(path("pieces"), folder, dirs_exist_ok=True)
            series = silt.open(os.path.join(folder, "particles.pvd"))
            os.remove(series.files[1].replace(".pvtp", "_r1.vtp"))
            self.raises("names the piece", lambda: series[1])

    def test_tables(self):
        table = silt.table(path("grains", "energy.csv"))
        self.assertEqual(table.names, ("time [s]", "kinetic energy [J]", "particles [-]"))
        self.assertEqual(table.units, {"time": "s", "kinetic energy": "J", "particles": "-"})
        self.assertEqual(table.rows.shape, (len(table), 3))
        self.assertTrue((table["particles"] == 120).all())
        frame = silt.open(path("grains", "particles.pvd"))[-1]
        mass = 2500 * 4 / 3 * np.pi * frame["radius"].astype(float) ** 3
        energy = 0.5 * mass * frame["|velocity|"] ** 2 + 0.2 * mass * frame["radius"] ** 2 * frame["|angular_velocity|"] ** 2
        self.assertAlmostEqual(energy.sum() / table["kinetic energy"][-1], 1, delta=1e-5)  # fields are floats
        self.raises("has no column 'heat'; it has: time [s], kinetic energy [J]", lambda: table["heat"])

    def test_odd_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "t.csv")

            def of(content):
                with open(name, "w") as file:
                    file.write(content)
                return name

            table = silt.table(of("id,what,x [m]\n18446744073709551615,ball,1\n3,wall,2\n4,cut of"))
            self.assertEqual(len(table), 2)  # the last row is not whole
            self.assertEqual(int(table["id"][0]), 2**64 - 1)  # not rounded
            self.assertEqual(list(table["what"]), ["ball", "wall"])
            self.raises("column 'what' has words", lambda: table.rows)
            self.assertEqual(len(silt.table(of("a,b\n"))), 0)
            self.raises("line 3 has 1 cells, but there are 2 columns", silt.table, of("a,b\n1,2\n3\n4,5\n"))
            self.raises("two columns 'a'", silt.table, of("a,a\n1,2\n"))
            self.raises("still being written", silt.table, of("a,b"))
            self.raises("cannot be read: No such file", silt.table, os.path.join(folder, "none.csv"))

    def test_summaries(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "summary.json")
            with open(name, "w") as file:
                json.dump({"inputs": {"radius [m]": 1e-3}, "versions": {"silt": "0.1.0"}, "results": {"mass [kg]": 2},
                           "checks": [{"name": "energy", "value": 1, "must_be": "<=", "limit": 2, "holds": True}]}, file)
            read = silt.summary(folder)
            self.assertEqual((read["mass [kg]"], read["radius [m]"], read.all_hold), (2, 1e-3, True))
            self.raises("has no result or input 'x'; it has: mass [kg], radius [m]", lambda: read["x"])
            self.assertEqual(read.numbers()["checks/energy/limit"], 2)
            with open(name, "w") as file:
                file.write('{"inputs": ')
            self.raises("is no JSON, or is cut off", silt.summary, name)


class Npz(Refuses, unittest.TestCase):
    def test_there_and_back(self):
        for name in ("grains/particles.pvd", "grains/contacts.pvd", "grains/walls.pvd", "flow/flow.pvd",
                     "shapes/surfaces.pvd", "pieces/particles.pvd"):
            if not has(name.split("/")[0]):
                continue
            series = silt.open(path(name))
            with tempfile.TemporaryDirectory() as folder:
                for target in ("all.npz", "each"):
                    back = silt.open(silt.npz_series(series, os.path.join(folder, target)))
                    np.testing.assert_array_equal(back.times, series.times)
                    self.assertEqual(back.steps, series.steps)
                    for a, b in zip(series, back):
                        self.assertEqual((a.fields, a.kind, len(a), a.units), (b.fields, b.kind, len(b), b.units))
                        for field in ("position", *a.fields):
                            np.testing.assert_array_equal(a[field], b[field], err_msg=f"{name} {field}")
                        if a.kind == "surface":
                            np.testing.assert_array_equal(a.corners, b.corners)

    def test_chosen_fields_and_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "some.npz")
            back = silt.open(silt.npz_series(path("grains", "particles.pvd"), name, ["velocity", "temperature"]))
            self.assertEqual(back[0].fields, ("velocity", "temperature [K]"))
            self.assertEqual(np.load(name)["2/field/velocity"].shape, (120, 3))
            self.raises("has no field 'charge'", silt.npz_series, path("grains"), name, ["charge"])
            with open(name, "r+b") as file:
                file.truncate(1000)
            self.raises("is no file of numpy's (.npz), or is cut off", silt.open, name)
            self.raises("cannot be written", silt.npz_series, path("grains"), os.path.join(folder, "no", "x.npz"))


class Errors(Refuses, unittest.TestCase):
    def test_half_written_files(self):
        with tempfile.TemporaryDirectory() as folder:
            name = silt.open(path("grains", "particles.pvd")).files[-1]
            with open(name, "rb") as file:
                whole = file.read()
            short = os.path.join(folder, "short.vtp")
            at = whole.index(b"<AppendedData")
            # Wherever a kill cuts the file off, it is a sentence, and never wrong numbers.
            for length in [*range(0, at + 40, 97), *range(at + 40, len(whole) - 40, 997)]:
                with open(short, "wb") as file:
                    file.write(whole[:length])
                with self.assertRaises(silt.Error) as caught:
                    frame = silt.read(short)
                    for field in ("position", *frame.fields):
                        frame[field]
                self.assertNotIn("\n", str(caught.exception))
            self.assertIn("is cut off before its end", str(caught.exception))
            with open(short, "wb") as file:
                file.write(whole[:at - 30])
            self.raises("is cut off in its header", silt.read, short)

    def test_files_that_are_not_there_or_no_such_files(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "x.vtp")
            self.raises("cannot be read: No such file", silt.open, name)
            open(name + ".partial", "w").close()
            self.raises("is still being written", silt.open, name)
            with open(name, "w") as file:
                file.write("a,b\n1,2\n")
            self.raises("is no VTK file in XML", silt.open(name).__getitem__, 0)
            open(name, "w").close()
            self.raises("is empty", silt.open(name).__getitem__, 0)
            lists = os.path.join(folder, "x.pvd")
            with open(path("grains", "particles.pvd")) as file:
                content = file.read()
            for part, words in ((content[:200], "is cut off; open its files themselves"), ("", "is empty"),
                                ("a,b\n", "is no series of VTK files")):
                with open(lists, "w") as file:
                    file.write(part)
                self.raises(words, silt.open, lists)
            with open(lists, "w") as file:
                file.write(content[:content.index("<DataSet")] + "</Collection></VTKFile>")
            self.assertEqual(len(silt.open(lists)), 0)
            self.raises("has no frames yet", lambda: silt.open(lists)[-1])
            self.raises("has no series (.pvd)", silt.open, tempfile.mkdtemp(dir=folder))
            self.raises("there is no file", silt.open, os.path.join(folder, "y_*.vtp"))
        self.raises("is a table: read it by silt.table", silt.open, path("grains", "energy.csv"))
        self.raises("is a checkpoint", silt.open, path("grains", "half.silt"))
        self.raises("has several series; open one of contacts.pvd, flow.pvd", silt.open, several())
        self.raises("'points' is no field: write frame.points", lambda: silt.open(path("grains"))[0]["points"])
        self.raises("has no field 'charge'; it has: radius, velocity, id", lambda: silt.open(path("grains"))[0]["charge"])
        self.raises("is no vector", lambda: silt.open(path("grains"))[0]["radius.z"])
        self.raises("no grid of cells", lambda: silt.open(path("grains"))[0].grid)
        with self.assertRaisesRegex(AttributeError, "module 'silt' has no 'opne'"):
            silt.opne

    def test_damaged_triangles(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "t.vtp")
            write_vtp(name, np.zeros((3, 3)), {"id": np.zeros(3, np.uint64)}, np.array([[0, 1, 3]], np.int32))
            self.raises("name points that are not there", lambda: silt.read(name).triangles)


def several():
    """A folder with two series, none of them of particles."""
    folder = os.path.join(path(), "several")
    os.makedirs(folder, exist_ok=True)
    shutil.copy(path("flow", "flow.pvd"), folder)
    shutil.copy(path("grains", "contacts.pvd"), folder)
    return folder


TYPES = {"f8": "Float64", "f4": "Float32", "i4": "Int32", "u8": "UInt64", "u4": "UInt32"}


def write_vtp(name, points, fields, triangles=None, encoding="raw", length="<u8", compressed=False):
    """A .vtp file in any of VTK's encodings, written here and not by silt."""
    data = b""

    def packed(values, base64_too):
        raw = np.ascontiguousarray(values).tobytes()
        head = np.dtype(length)
        if not compressed:
            whole = np.array([len(raw)], head).tobytes() + raw
            return base64.b64encode(whole) if base64_too else whole
        blocks = [zlib.compress(raw[k:k + 64]) for k in range(0, max(len(raw), 1), 64)]
        start = np.array([len(blocks), 64, len(raw) % 64, *map(len, blocks)], head).tobytes()
        return base64.b64encode(start) + base64.b64encode(b"".join(blocks)) if base64_too else start + b"".join(blocks)

    def array(called, values):
        nonlocal data
        values = np.asarray(values)
        about = (f'<DataArray type="{TYPES[values.dtype.str[1:]]}" Name="{called}" '
                 f'NumberOfComponents="{1 if values.ndim == 1 else values.shape[1]}" ')
        if encoding == "ascii":
            return about + 'format="ascii">' + " ".join(repr(v.item()) for v in values.reshape(-1)) + "</DataArray>"
        if encoding == "binary":
            return about + 'format="binary">\n  ' + packed(values, True).decode() + "\n</DataArray>"
        offset = len(data)
        data += packed(values, encoding == "base64")
        return about + f'format="appended" offset="{offset}"/>'

    polys = 0 if triangles is None else len(triangles)
    body = (f'<PolyData><Piece NumberOfPoints="{len(points)}" NumberOfPolys="{polys}"><PointData>'
            + "".join(array(n, v) for n, v in fields.items()) + "</PointData><Points>"
            + array("Points", np.asarray(points, float)) + "</Points>")
    if triangles is not None:
        body += ("<Polys>" + array("connectivity", triangles.reshape(-1))
                 + array("offsets", np.arange(3, 3 * polys + 1, 3, dtype=np.int32)) + "</Polys>")
    body += "</Piece></PolyData>"
    if encoding in ("raw", "base64"):
        body += f'<AppendedData encoding="{encoding}">_'
    with open(name, "wb") as file:
        file.write(f'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type='
                   f'"{TYPES[length[1:]]}"{" compressor=" + chr(34) + "vtkZLibDataCompressor" + chr(34) if compressed else ""}>'
                   .encode() + body.encode() + data
                   + (b"</AppendedData>" if encoding in ("raw", "base64") else b"") + b"</VTKFile>")


class Encodings(unittest.TestCase):
    def test_what_paraview_may_save(self):
        rng = np.random.default_rng(4)
        points = rng.normal(size=(37, 3))
        fields = {"radius": rng.random(37, np.float32), "id": rng.integers(0, 2**63, 37).astype(np.uint64),
                  "velocity": rng.normal(size=(37, 3))}
        triangles = rng.integers(0, 37, (11, 3)).astype(np.int32)
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "a.vtp")
            for encoding in ("raw", "base64", "binary", "ascii"):
                for length in ("<u8", "<u4"):
                    for compressed in (False, True):
                        write_vtp(name, points, fields, triangles, encoding, length, compressed)
                        frame = silt.read(name)
                        np.testing.assert_array_equal(frame["position"], points)
                        np.testing.assert_array_equal(frame.triangles, triangles)
                        for field, values in fields.items():
                            np.testing.assert_array_equal(frame[field], values, err_msg=f"{encoding} {length} {compressed}")

    def test_an_empty_file(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "a.vtp")
            write_vtp(name, np.empty((0, 3)), {"id": np.empty(0, np.uint64)})
            self.assertEqual(len(silt.read(name)), 0)
            self.assertEqual(silt.read(name).find([3])[0], -1)


class Spans(unittest.TestCase):
    def test_the_number_for_no_particle_is_not_shown(self):
        from silt.info import _span

        nobody = np.iinfo(np.uint64).max
        self.assertEqual(_span(np.array([3, nobody, 7], np.uint64)), "3 to 7 (1 none)")
        self.assertEqual(_span(np.array([nobody], np.uint64)), "none")


class CheckpointHead(Refuses, unittest.TestCase):
    def test_info_of_checkpoints(self):
        from silt.info import describe

        words = describe(path("grains", "half.silt"))
        self.assertIn("contacts silt::Contacts<silt::BasicHertzMindlin", words)
        self.assertIn("clock.time", words)
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "x.silt")
            with open(path("grains", "half.silt"), "rb") as file:
                whole = file.read()
            for content, sentence in ((whole[:-1], "is cut off"), (whole[:20], "is cut off"),
                                      (whole[:12] + struct.pack("<I", 9) + whole[16:], "is of version 9")):
                with open(name, "wb") as file:
                    file.write(content)
                self.raises(sentence, describe, name)


if __name__ == "__main__":
    unittest.main()
