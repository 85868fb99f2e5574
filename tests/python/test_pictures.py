# silt - BSD-3-Clause, see LICENSE
"""Pictures: the rasteriser against a plain one, and what is at which pixel of files that are drawn.

Each check names the wrong picture that it catches.
"""

import math
import os
import resource
import shutil
import subprocess
import tempfile
import unittest

import matplotlib.image
import numpy as np
import silt
from matplotlib.colors import to_rgb
from scenes import Refuses, has, needs, path, run, run_apart
from silt import drawing
from silt.command import parse
from silt.drawing import Canvas, Cut, view_axes
from silt.drawing import cells as cells_module
from silt.drawing import curves as curves_module
from silt.drawing import scene, style
from silt.drawing.bodies import Bed, pressing
from silt.drawing.planes import Planes
from test_readers import write_vtp

rng = np.random.default_rng(1)
GREY = np.full((1, 3), 0.6)


def picture(name):
    """(rows, columns, 3) from 0 to 1, row 0 the lowest."""
    return matplotlib.image.imread(name)[::-1, :, :3]


def colourful(image):
    """How far each pixel is from grey."""
    return image.max(axis=2) - image.min(axis=2)


def ball(around=24, down=16):
    """A sphere's points and triangles, which run anticlockwise as seen from outside."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(down + 1) * np.pi / down)
    points = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=2)
    k = np.arange(around * down).reshape(down, around)
    right = np.roll(k, -1, axis=1)
    triangles = np.stack([k, k + around, right, right, k + around, right + around], axis=2)
    return points.reshape(-1, 3), triangles.reshape(-1, 3)


def figure_of(*arguments):
    """The figure of `silt draw ARGUMENTS` and its scene, without a file."""
    options = parse(["draw", *map(str, arguments), "-o", "none.png"])
    one = scene.Scene(options)
    panels, extent = one._load(one.shots())
    return one.figure(panels, extent, [""] * len(panels)), panels


class Rasteriser(unittest.TestCase):
    def test_triangles_against_one_after_the_other(self):
        """In any order, slivers too, some beyond the picture, at the middle of every pixel. Catches gaps
        between neighbours, wrong depths, and triangles skipped as hidden that are not."""
        corners = np.concatenate([rng.uniform(-80, 280, (150, 3, 3)),
                                  rng.uniform(-5, 195, (600, 1, 3)) + rng.uniform(0, 12, (600, 3, 3))])
        canvas = Canvas([0, 100, 0, 100], 100)
        owner = canvas.front_triangles(corners, canvas.depth, portion=2000)
        x, y = np.meshgrid(np.arange(200) + 0.5, np.arange(200) + 0.5)
        depth = np.full((200, 200), -np.inf)
        for a, b, c in corners:
            whole = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
            v = ((x - a[0]) * (c - a)[1] - (y - a[1]) * (c - a)[0]) / whole
            w = ((b - a)[0] * (y - a[1]) - (b - a)[1] * (x - a[0])) / whole
            z = np.where((v >= 0) & (w >= 0) & (v + w <= 1),
                         (1 - v - w) * a[2] + v * b[2] + w * c[2], -np.inf)
            depth = np.maximum(depth, z)
        both = np.isfinite(depth) & np.isfinite(canvas.depth)
        self.assertLessEqual((np.isfinite(depth) != np.isfinite(canvas.depth)).sum(), 4, "pixels covered")
        self.assertLessEqual((np.abs(depth[both] - canvas.depth[both]) > 0.01).sum(), 4, "depths")
        self.assertTrue(((owner >= 0) == np.isfinite(canvas.depth)).all())

    def test_spheres_against_one_after_the_other(self):
        """Sizes from less than a pixel to a third of the picture, in portions, parallel and in
        perspective, overlapping. Catches outlines, depths and spheres skipped as hidden that are not."""
        places = rng.uniform(-10, 110, (400, 3))
        radii = np.exp(rng.uniform(np.log(0.1), np.log(30), 400))
        radii[:300] *= 0.1
        for eye in (None, (60, 40, 400)):
            canvas = Canvas([0, 100, 0, 100], 100, eye, plane=50)
            owner = canvas._front_spheres(places, radii, portion=2000)
            column, row = np.meshgrid(np.arange(200), np.arange(200))
            depth = np.full((200, 200), -np.inf)
            big = 0.8 / canvas.scale  # [m] smaller ones are dots
            for (px, py, pz), r in zip(places, radii):
                if eye is None:
                    dx, dy = (column + 0.5) / 2 - px, (row + 0.5) / 2 - py
                    rest = r * r - dx * dx - dy * dy
                    z = pz + np.sqrt(np.maximum(rest, 0))
                else:  # points eye + t (target - eye), on the plane z = 50 at t = 1
                    d = np.stack([(column + 0.5) / 2 - eye[0], (row + 0.5) / 2 - eye[1],
                                  np.full(column.shape, 50.0 - eye[2])], axis=-1)
                    c = np.array([px, py, pz]) - eye
                    rest = (d @ c) ** 2 - (d * d).sum(axis=-1) * (c @ c - r * r)
                    t = (d @ c - np.sqrt(np.maximum(rest, 0))) / (d * d).sum(axis=-1)
                    z = eye[2] + t * (50.0 - eye[2])
                if r > big:
                    depth = np.where(rest >= 0, np.maximum(depth, z), depth)
            seen = owner >= 0
            large = seen & (radii[np.maximum(owner, 0)] > big)
            mine = canvas.depth / canvas.scale if eye is None else \
                eye[2] - 350 / (1 + canvas.depth / (350 * canvas.scale))
            self.assertLessEqual((np.isfinite(depth) & ~seen).sum(), 0)
            self.assertLessEqual((np.abs(depth[large] - mine[large]) > 1e-3).sum(), 2, f"eye {eye}")
            dots = seen & ~large  # in front of what is there, a pixel or few each
            self.assertGreater(dots.sum(), 20)
            self.assertTrue((mine[dots] >= depth[dots] - 1e-3).all())

    def test_a_large_triangle_between_nearer_ones(self):
        near = np.array([[-60, -60, 100], [100, -60, 100], [20, 100, 100]], float)
        corners = np.concatenate([[near + [dx, dy, 0] for dx in (0, 160) for dy in (0, 170)],
                                  [[[10, 10, 0], [190, 10, 0], [100, 190, 0]]]])
        canvas = Canvas([0, 100, 0, 100], 100)
        owner = canvas.front_triangles(corners, canvas.depth, portion=1000)
        self.assertEqual(owner[100, 100], 4, "a large triangle between nearer ones is taken for hidden")

    def test_a_sphere_of_triangles_looks_like_a_sphere(self):
        """Catches normals turned inside out or not interpolated."""
        form, facets = ball(96, 64)
        for eye in (None, (0, 0, 6)):
            pictures = []
            facing = (form[facets[:, 0]] * ((eye or (0, 0, 1e9)) - form[facets[:, 0]])).sum(axis=1) > 0
            shown = facets[facing]
            for draw_it in (lambda c: c.draw_spheres(np.zeros((1, 3)), np.ones(1), GREY),
                            lambda c: c.draw_triangles(form, shown, form[shown], np.repeat(GREY, len(form), 0))):
                canvas = Canvas([-1.2, 1.2, -1.2, 1.2], 150, eye)
                draw_it(canvas)
                pictures.append((canvas.image, np.isfinite(canvas.depth)))
            middle = np.hypot(*np.meshgrid(*[np.linspace(-1.2, 1.2, 300)] * 2)) < 0.85
            self.assertLess((pictures[0][1] != pictures[1][1]).mean(), 0.012, "outlines")
            difference = np.abs(pictures[0][0] - pictures[1][0])[middle].mean()
            self.assertLess(difference, 0.04, "shades")

    def test_perspective(self):
        """A ball twice as far away is half as large; one at the plane has its size; one behind the eye
        is left out. Of a ball of radius 1 at distance D the outline has the tangent's radius."""
        eye = (0.0, 0.0, 10.0)
        for z, r in ((0, 10 / np.sqrt(99)), (-10, 10 / np.sqrt(399))):
            canvas = Canvas([-3, 3, -3, 3], 150, eye)
            canvas.draw_spheres(np.array([[0.0, 0, z]]), np.ones(1), GREY)
            covered = np.isfinite(canvas.depth).sum() / canvas.scale ** 2
            self.assertAlmostEqual(np.sqrt(covered / np.pi) / r, 1, delta=0.01)
        canvas = Canvas([-3, 3, -3, 3], 150, eye)
        canvas.draw_spheres(np.array([[0.0, 0, 11], [0, 0, 9.5]]), np.ones(2), np.repeat(GREY, 2, 0))
        self.assertFalse(np.isfinite(canvas.depth).any(), "what is behind or around the eye is drawn")
        corners = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 20]]], float)
        canvas.draw_walls(corners)
        self.assertTrue((canvas.image == 1).all(), "a triangle around the eye is drawn")

    def test_walls(self):
        """In front of grains they leave them as they are, beside grains they tint, and of two the farther
        shows; solid ones hide, glass veils. Catches walls that hide grains unasked."""
        def square(z, half, slope=0.0):
            p = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
            p[:, 2] += slope * p[:, 0]
            return p[[[0, 1, 2], [0, 2, 3]]]

        def grain():
            canvas = Canvas([-1.2, 1.2, -1.2, 1.2], 150)
            canvas.draw_spheres(np.zeros((1, 3)), np.full(1, 0.5), np.array([[0.1, 0.6, 0.2]]))
            return canvas, canvas.image.copy(), np.isfinite(canvas.depth)

        for wall in (square(5, 1.1), square(-5, 1.1)):
            canvas, before, there = grain()
            canvas.draw_walls(wall)
            self.assertTrue((canvas.image[there] == before[there]).all())
            tinted = (canvas.image < 0.99).any(axis=2) & ~there
            self.assertLess(abs(tinted.mean() + there.mean() - (1.1 / 1.2) ** 2), 0.01)
        one, two = (Canvas([-1.2, 1.2, -1.2, 1.2], 50) for _ in range(2))
        one.draw_walls(square(-5, 1.1, slope=1.0))
        two.draw_walls(np.concatenate([square(5, 1.1), square(-5, 1.1, slope=1.0)]))
        self.assertTrue((one.image == two.image).all(), "the nearer of two walls is seen")
        for z, hidden in ((5, True), (-5, False)):
            canvas, before, there = grain()
            canvas.draw_solid_walls(square(z, 1.1))
            self.assertEqual((colourful(canvas.image[there][None]) < 0.1).all(), hidden)
            canvas, before, there = grain()
            canvas.draw_glass_walls(square(z, 1.1))
            green = colourful(canvas.image[there][None]).mean() / colourful(before[there][None]).mean()
            self.assertAlmostEqual(green, 0.9 if hidden else 1, delta=0.04)


class Views(Refuses, unittest.TestCase):
    def test_axes(self):
        for view in ("front", "back", "side", "left", "top", "bottom", "iso", "30,-10"):
            axes = view_axes(view)
            np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12, err_msg=view)
            self.assertAlmostEqual(np.linalg.det(axes), 1, msg=view)  # not a mirror
        np.testing.assert_array_equal(view_axes("front"), [[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        np.testing.assert_array_equal(view_axes("side"), [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
        np.testing.assert_array_equal(view_axes("top"), [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
        self.raises("must be one of iso, front", view_axes, "behind")

    def test_cuts(self):
        """What is in front is taken from walls too: catches back walls that go with the front ones."""
        wall = np.array([[[0, 0, 0], [0, 1, 0], [0, 1, 1]], [[0, 0, 0], [0, 1, 1], [0, 0, 1]]], float)
        for words, area, least, most in (("y=0.25", 0.75, 0.25, 1), ("y>0.25", 0.75, 0.25, 1),
                                         ("y<0.25", 0.25, 0, 0.25)):
            kept = Cut(words, view_axes("front")).clip_triangles(wall)
            found = np.linalg.norm(np.cross(kept[:, 1] - kept[:, 0], kept[:, 2] - kept[:, 0]), axis=1).sum() / 2
            self.assertAlmostEqual(found, area)
            self.assertGreaterEqual(kept[:, :, 1].min(), least - 1e-12)
            self.assertLessEqual(kept[:, :, 1].max(), most + 1e-12)
        self.raises("must be an axis and a place", Cut, "w=3", view_axes("front"))


class Drawn(Refuses, unittest.TestCase):
    """Files of a program, as a user draws them."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "x.png")

    def tearDown(self):
        style.plt.close("all")
        shutil.rmtree(self.folder)

    def draw(self, *arguments):
        done = run("draw", *arguments, "-o", self.out)
        self.assertEqual((done.returncode, done.stderr), (0, ""), arguments)
        return picture(self.out)

    def test_spheres_are_where_the_file_says_in_the_colours_of_their_values(self):
        figure, [layers] = figure_of(path("grains", "particles.pvd"), "--colour", "temperature", "--walls", "none")
        frame = silt.open(path("grains", "particles.pvd"))[-1]
        panel = figure.axes[0]
        image = panel.images[0].get_array()
        left, right, bottom, top = panel.images[0].get_extent()
        front = frame["position"][:, 1] - frame["radius"]
        checked = 0
        colours = drawing.COLOUR_MAP((frame["temperature"] - frame["temperature"].min()) / np.ptp(frame["temperature"]))
        for k in np.argsort(front)[:20]:  # nothing is before them at their middles
            x, _, z = frame["position"][k]
            others = np.hypot(frame["position"][:, 0] - x, frame["position"][:, 2] - z) < frame["radius"]
            if (front[others] < frame["position"][k, 1]).sum() > 1:
                continue
            row = int((top - z) / (top - bottom) * image.shape[0])
            column = int((x - left) / (right - left) * image.shape[1])
            seen, wanted = image[row, column], colours[k, :3]
            # As bright or darker by the shade, and of the same hue.
            shade = (seen @ wanted) / (wanted @ wanted)
            self.assertTrue(0.5 < shade < 1.01, f"ball {k}: shade {shade}")
            np.testing.assert_allclose(seen, shade * wanted, atol=0.02)
            checked += 1
        self.assertGreater(checked, 8)

    def test_the_picture_that_is_saved(self):
        image = self.draw(path("grains", "particles.pvd"), "--colour", "velocity")
        # The beads lie in the lower fifth of their box, which takes about half of the picture.
        self.assertGreater((colourful(image) > 0.15).mean(), 0.05)
        white = (image > 0.99).all(axis=2)
        self.assertGreater(white.mean(), 0.2)
        self.assertTrue(white[[0, -1]].all() and white[:, [0, -1]].all(), "something leaves the picture")
        grey = self.draw(path("grains", "particles.pvd"))
        self.assertGreater(np.abs(grey[:100, :100] - 1).max(), 0.5, "no scale bar")

    def test_the_width_of_a_picture(self):
        image = self.draw(path("grains", "particles.pvd"), "--colour", "velocity", "--width", 600)
        self.assertEqual(image.shape[1], 600)
        self.refused("pixels from 100", "draw", path("grains"), "--width", 7, "-o", self.out)

    @needs("shapes")
    def test_true_shapes(self):
        """Of bodies their surfaces or parts are drawn, with fields of the file of particles by id. Catches
        bounding spheres, which cover more, and fields that go to other bodies."""
        for folder, is_surface in (("shapes", True), ("parts", False)):
            _, [layers] = figure_of(path(folder, "particles.pvd"), "--colour", "angular_velocity", "--walls", "none")
            frame = silt.open(path(folder, "particles.pvd"))[-1]
            bed = layers.bed
            self.assertEqual(bed.has_surfaces, is_surface)
            shape = silt.open(path(folder, "surfaces.pvd" if is_surface else "parts.pvd"))[-1]
            expected = frame["|angular_velocity|"][frame.find(shape.ids)]
            np.testing.assert_allclose(bed.values, expected)
            self.assertEqual(bed.label, "|angular velocity| [rad/s]")
        image = self.draw(path("shapes", "particles.pvd"), "--colour", "form", "--names", "bead,pill,brick",
                          "--view", "iso")
        for colour in drawing.COLOURS[:3]:  # each form's colour, shaded, on some pixels
            hue = np.array(to_rgb(colour))
            hue = hue / hue.max()
            share = image / np.maximum(image.max(axis=2, keepdims=True), 1e-9)
            self.assertGreater((np.abs(share - hue).max(axis=2) < 0.06).mean(), 0.005, colour)

    def test_times_and_frames(self):
        figure, panels = figure_of(path("grains"), "--time", "0", "0.04", "0.1")
        self.assertEqual(len(panels), 3)
        z = [layers.bed.places[:, 1].mean() for layers in panels]
        self.assertTrue(z[0] > z[1] > z[2], "the bed falls")
        _, panels = figure_of(path("grains"), "--frame", "0", "-1")
        self.assertEqual([layers.bed.places[:, 1].mean() for layers in panels], [z[0], z[2]])
        self.refused("has 3 frames, no number 3", "draw", path("grains"), "--frame", 3, "-o", self.out)

    def test_contacts_and_bonds(self):
        _, [layers] = figure_of(path("grains"), "--contacts", path("grains", "contacts.pvd"),
                                "--bonds", path("grains", "bonds.pvd"), "--bond-colour", "load")
        frame = silt.open(path("grains", "contacts.pvd"))[-1]
        self.assertEqual(len(layers.contacts), (frame["normal_force"] > 0).sum())
        np.testing.assert_array_equal(layers.forces, np.sort(frame["normal_force"][frame["normal_force"] > 0]))
        bonds = silt.open(path("grains", "bonds.pvd"))[-1]
        np.testing.assert_array_equal(layers.load, bonds["load"])
        figure, _ = figure_of(path("grains", "contacts.pvd"))
        widths = np.asarray(figure.axes[0].collections[0].get_linewidths())
        self.assertTrue((np.diff(widths) >= 0).all() and widths[-1] > 2.5 > 0.5 > widths[0], "width follows force")
        image = self.draw(path("grains", "bonds.pvd"), "--view", "iso")
        self.assertGreater((colourful(image) > 0.2).mean(), 0.002)
        self.refused("has no triangles", "draw", path("grains"), "--walls", path("grains", "contacts.pvd"),
                     "-o", self.out)
        self.raises("no particles or bodies", Bed, path("grains", "contacts.pvd"), None, view_axes("front"))

    def test_spheres_without_bonds_keep_their_size(self):
        """Catches all spheres halved beside bonds, and bonds taken for those of other ids."""
        name, bonds = (os.path.join(self.folder, n) for n in ("balls.vtp", "bonds.vtp"))
        places = np.array([[k, 0, 0] for k in range(4)], float)
        write_vtp(name, places, {"id": np.array([9, 4, 7, 2], np.int32), "radius": np.full(4, 0.4)})
        write_lines(bonds, places[[1, 2]], {"bending": np.zeros(1), "load": np.ones(1), "a": np.array([7], np.int32),
                                            "b": np.array([4], np.int32)})
        _, [layers] = figure_of(name, "--bonds", bonds)
        np.testing.assert_allclose(scene.shown_radii(layers.bed, layers), [0.4, 0.2, 0.2, 0.4])
        _, [layers] = figure_of(name)
        np.testing.assert_allclose(scene.shown_radii(layers.bed, layers), 0.4)
        self.refused("but the bonds have: say --bond-colour load", "draw", name, "--bonds", bonds, "--colour", "load",
                     "-o", self.out)

    def test_single_files(self):
        """Catches a second, empty panel beside files --together under the name of the first alone, and panels
        of --time that are left out."""
        kept, save = [], scene.save
        scene.save = lambda figure, *_: kept.append(figure)
        try:
            files = [os.path.join(self.folder, name + ".vtp") for name in ("water", "ball")]
            for name, more in zip(files, ({}, {"radius": np.full(3, 0.5)})):
                write_vtp(name, np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]], float), more)
            for options, captions in ((["--together"], [""]), ([], ["water", "ball"]),
                                      (["--time", 0, 1], ["water", "water", "ball", "ball"])):
                self.assertEqual(run("draw", *files, *options, "-o", self.out).returncode, 0)
                figure = kept.pop()
                panels = [axes for axes in figure.axes if axes.images]
                self.assertEqual([axes.get_title() for axes in panels], captions)
                used = panels[0].get_position().width * figure.get_figwidth() * min(len(panels), 2)
                self.assertGreater(used, 0.6 * figure.get_figwidth(), "room for a panel that is not there")
        finally:
            scene.save = save

    def test_panels_are_on_whole_pixels(self):
        """Catches a row or column of pixels that is shown twice, a jog in slanting lines."""
        for width in (None, 641):
            figure, _ = figure_of(path("grains"), "--time", "0", "0.1", *(["--width", width] if width else []))
            dpi = width / figure.get_figwidth() if width else style.DPI
            sheet = figure.get_size_inches() * dpi
            np.testing.assert_allclose(sheet, np.round(sheet), atol=1e-6)
            for axes in figure.axes[:2]:
                rows, columns = axes.images[0].get_array().shape[:2]
                left, bottom, across, up = axes.get_position().bounds * np.tile(sheet, 2)
                np.testing.assert_allclose([left, bottom], np.round([left, bottom]), atol=1e-6)
                np.testing.assert_allclose([across, up], [columns, rows], atol=1e-6)

    def test_bodies_without_their_shapes(self):
        """Catches bounding spheres drawn in silence."""
        name = os.path.join(self.folder, "body.vtp")
        write_vtp(name, np.zeros((1, 3)), {"radius": np.full(1, 0.5), "orientation": np.array([[1.0, 0, 0, 0]])})
        done = run("draw", name, "--perspective", "-o", self.out)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1))
        self.assertIn("drawn as their bounding spheres; vtk_series writes surfaces.pvd", done.stderr)

    def test_a_liquid_and_bodies_together(self):
        """Catches panels side by side, frames of other times, a field that one file does not have."""
        def series(word, times, shift, fields):
            entries = []
            for k, t in enumerate(times):
                n = len(next(iter(fields.values())))
                places = np.array([[j + shift, 0, t] for j in range(n)], float)
                write_vtp(os.path.join(self.folder, f"{word}_{k}.vtp"), places, fields)
                entries.append(f'<DataSet timestep="{t}" file="{word}_{k}.vtp"/>')
            listed = os.path.join(self.folder, word + ".pvd")
            with open(listed, "w") as file:
                file.write(f'<VTKFile type="Collection"><Collection>{"".join(entries)}</Collection></VTKFile>')
            return listed

        water = series("water", (0, 1, 2), 0, {"pressure [Pa]": np.linspace(0.5, 9.5, 8), "speed": np.full(8, 0.5)})
        balls = series("balls", (0, 2), 20, {"radius": np.full(3, 0.5), "id": np.arange(3, dtype=np.int32),
                                             "speed": np.full(3, 1.5)})
        figure, [layers] = figure_of(water, balls, "--together", "--colour", "pressure")
        self.assertEqual((len(layers.bed.values), len(layers.others[0].values)), (8, 3))
        self.assertEqual((layers.bed.label, layers.others[0].label), ("pressure [Pa]", ""))
        self.assertEqual(layers.others[0].places[:, 1].tolist(), [2, 2, 2])
        _, panels = figure_of(balls, water, "--together", "--colour", "speed", "--time", "0", "2")
        self.assertEqual([one.others[0].places[0, 1] for one in panels], [0, 2])
        self.assertEqual([one.others[0].is_liquid for one in panels], [True, True])
        figure, _ = figure_of(water, balls, "--together", "--colour", "speed")
        self.assertEqual(figure.axes[-1].get_xlim(), (0.5, 1.5))
        image = self.draw(water, balls, "--together", "--colour", "pressure")
        plain = np.array(to_rgb(style.PLAIN))
        seen = image[colourful(image) > 0.1]
        brown = np.abs(seen / seen.max(axis=1, keepdims=True) - plain / plain.max()).max(axis=1) < 0.05
        self.assertTrue(0.1 < brown.mean() < 0.9, "bodies are plain, the liquid is coloured")
        self.assertEqual(len(figure_of(water, balls)[1]), 2)
        self.refused("has no field 'heat'", "draw", water, balls, "--together", "--colour", "heat", "-o", self.out)
        frames = os.path.join(self.folder, "f_%d.png")
        self.assertEqual(run("draw", water, balls, "--together", "-o", frames).returncode, 0)
        self.refused("2 titles for 1 picture", "draw", water, balls, "--together", "--title", "a", "b", "-o", frames)

    def test_a_colour_each_for_few_whole_numbers(self):
        """Kept as doubles too. Catches a bar from 0 to 1, names that are refused, 300 K and 310 K as kinds."""
        name = os.path.join(self.folder, "balls.vtp")
        state = np.array([0, 1, 1, 0, 1.0])
        write_vtp(name, np.arange(15.0).reshape(5, 3), {
            "radius": np.full(5, 0.5), "layer": state, "T [K]": 300 + 10 * state, "part": state + 0.25,
            "many": np.arange(5.0) - 1})
        figure, _ = figure_of(name, "--colour", "layer", "--names", "bottom,top")
        self.assertEqual([t.get_text() for t in figure.axes[-1].get_legend().get_texts()], ["bottom", "top"])
        figure, _ = figure_of(name, "--colour", "layer")
        self.assertEqual([t.get_text() for t in figure.axes[-1].get_legend().get_texts()], ["0", "1"])
        for colour in ("T", "part"):
            self.assertIsNone(figure_of(name, "--colour", colour)[0].axes[-1].get_legend())
        for words, more in (("'part' has the value 0.25", ("part",)), ("'many' has the values -1, 0, 1", ("many",)),
                            ("--range makes it", ("layer", "--range", "0,1")), ("'T' has the values 300, 310", ("T",))):
            self.refused(words, "draw", name, "--names", "bottom,top", "--colour", *more, "-o", self.out)
        self.refused("there is no --colour", "draw", name, "--names", "bottom,top", "-o", self.out)

    def test_ends_of_the_signed_map_and_of_forces(self):
        """Catches a signed map whose middle is not 0, and a range of forces without effect."""
        signed = style.ColourScale(np.array([-1.5, 0.25, 4.5]), "charge [nC]", None, None, style.COLOUR_MAPS["signed"])
        self.assertEqual((signed.norm.vmin, signed.norm.vmax), (-4.5, 4.5))
        widths = {}
        for more, ends in (((), None), (("--range", "0.001,0.004"), (0.001, 0.004))):
            figure, _ = figure_of(path("grains", "contacts.pvd"), *more)
            low, high = figure.axes[-1].get_xlim()
            if ends:
                self.assertEqual((round(low, 6), round(high, 6)), ends)
            else:
                self.assertEqual(low, 0)
            lines = figure.axes[0].collections[0]
            widths[more] = np.array(lines.get_linewidths())
        self.assertFalse(np.allclose(widths[()], widths[more]))

    def test_one_outlier_does_not_take_the_colours(self):
        """Catches a colour bar that a single value stretches, and one that clips what is usual."""
        values = np.r_[np.linspace(0.1, 1.1, 999), 50.0]
        scale = style.ColourScale(scene.brief(values), "speed [m/s]")
        self.assertEqual(scale.extend, "max")
        self.assertAlmostEqual(scale.norm.vmax, 1.1, delta=0.03)
        self.assertEqual(scale.norm.vmin, 0.1)
        low = style.ColourScale(scene.brief(np.tile(-values, 7)), "speed [m/s]")
        self.assertEqual((low.extend, low.norm.vmax), ("min", -0.1))
        self.assertAlmostEqual(low.norm.vmin, -1.1, delta=0.03)
        for plain in (rng.normal(size=5000), np.r_[np.zeros(999), 3.5], values[:999], np.r_[values[:50], 50.0]):
            scale = style.ColourScale(scene.brief(plain), "speed [m/s]")
            self.assertEqual((scale.extend, scale.norm.vmin, scale.norm.vmax), ("neither", plain.min(), plain.max()))
        given = style.ColourScale(scene.brief(values), "speed [m/s]", [0, 100])
        self.assertEqual((given.norm.vmin, given.norm.vmax), (0, 100))

    def test_slabs(self):
        """Of four contacts across the picture, two lie in the slab and press. Catches lines left out of a
        slab or drawn in another place, and pulls drawn as pushes."""
        name = os.path.join(self.folder, "contacts.vtp")
        ends = np.array([[x, y, z] for y, z in ((0, 0), (0, 1), (0.5, 2), (0, 3)) for x in (0, 3)], float)
        write_lines(name, ends, {"normal_force": np.array([1, 2, 3, -1], np.float32)})
        axes = view_axes("front")
        for slab, heights in (("y=-0.1,0.1", [0, 1]), ("y=0.4,0.6", [2]), (None, [0, 1, 2])):
            lines, force = pressing(silt.read(name), scene.slab_cuts(slab, axes) if slab else ())
            self.assertEqual(lines[:, :, 2].tolist(), [[z, z] for z in heights])
            self.assertEqual(force.tolist(), [z + 1 for z in heights])
        self.draw(name, "--slab", "y=-0.1,0.1")
        self.refused("there is nothing to draw", "draw", name, "--slab", "y=7,8", "-o", self.out)
        walls = ("draw", path("grains", "particles.pvd"), "-o", self.out, "--slab")
        self.assertIn("--slab leaves nothing but walls", run(*walls, "y=7,8").stderr)
        self.assertNotIn("--slab", run(*walls, "y=-7,8").stderr)
        self.refused("an axis and two places", "draw", name, "--slab", "w=7,8", "-o", self.out)

    def test_a_slice_of_a_flow(self):
        """Catches cells mirrored, turned or a layer off: the value of each pixel is that of its place."""
        figure, [layers] = figure_of(path("flow", "flow.pvd"), "--colour", "pressure", "--slice", "y=0.0035")
        self.assertEqual(layers.flow_label, "pressure [Pa]")
        middle = layers.cells.mean(axis=1)  # of triangles, in view coordinates: x, z, -y
        np.testing.assert_allclose(middle[:, 2], -0.0035)
        x = 1e-3 * (np.floor(middle[:, 0] * 1e3) + 0.5)
        z = 1e-3 * (np.floor(middle[:, 1] * 1e3) + 0.5)
        np.testing.assert_allclose(layers.flow, x + 10 * 0.003 + 100 * z, rtol=1e-9)
        self.assertEqual(len(layers.flow), 2 * (4 * 5 - 1), "the closed cell is left out")
        panel = figure.axes[0]
        image = panel.images[0].get_array()
        left, right, bottom, top = panel.images[0].get_extent()
        norm = matplotlib.colors.Normalize(layers.flow.min(), layers.flow.max())
        for x, z in ((0.0015, 0.0005), (0.0045, 0.0005), (0.0015, 0.0045), (0.0025, 0.0025)):
            seen = image[int((top - z) / (top - bottom) * image.shape[0]), int((x - left) / (right - left) * image.shape[1])]
            np.testing.assert_allclose(seen, drawing.COLOUR_MAP(norm(x + 10 * 0.003 + 100 * z))[:3], atol=0.01)
        self.draw(path("flow", "flow.pvd"))  # velocity, in the middle
        self.refused("is not in the grid", "draw", path("flow", "flow.pvd"), "--slice", "y=1", "-o", self.out)
        self.refused("an axis and a place", "draw", path("flow", "flow.pvd"), "--slice", "q", "-o", self.out)

    def test_everything_in_one_picture(self):
        figure, [layers] = figure_of(path("grains"), "--colour", "velocity", "--flow", path("flow", "flow.pvd"),
                                     "--flow-colour", "pressure", "--contacts", path("grains", "contacts.pvd"),
                                     "--bonds", path("grains", "bonds.pvd"), "--bond-colour", "load",
                                     "--walls-as", "glass", "--view", "iso", "--perspective")
        figure.canvas.draw()
        bars = [axes.get_xlabel() for axes in figure.axes[1:]]
        self.assertEqual(bars, ["|velocity| [m/s]", "pressure [Pa]", "load [-]", "normal force [N]"])
        boxes = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in figure.axes[1:]]
        self.assertFalse(any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k]), "colour bars overlap")

    def test_cuts_and_bounds(self):
        _, [layers] = figure_of(path("grains"), "--cut", "x>0.005", "--cut", "x<0.01")
        x = layers.bed.places[:, 0]
        self.assertTrue(0.005 <= x.min() and x.max() <= 0.01 and 5 < len(x) < 100)
        figure, _ = figure_of(path("grains"), "--bounds", "-0.01,0.03,-0.02,0.06")
        self.assertEqual(list(figure.axes[0].images[0].get_extent()), [-0.01, 0.03, -0.02, 0.06])
        self.refused("the lower one of each pair first", "draw", path("grains"), "--bounds", "0,-1,0,1", "-o", self.out)
        self.refused("there is nothing to draw", "draw", path("grains"), "--walls", "none", "--cut", "y=1", "-o", self.out)

    def test_walls_beside_a_series(self):
        for arguments, name in (((), "grains"), (("--walls", "none"), None),
                                (("--walls", path("other", "walls.pvd")), "other")):
            count = len(silt.open(path(name, "walls.pvd"))[-1].triangles) if name else 0
            _, [layers] = figure_of(path("grains", "particles.pvd"), *arguments)
            self.assertEqual(len(layers.walls), count, arguments)
            self.assertEqual(count > 0, name is not None)

    def test_planes_are_as_large_in_all_frames(self):
        """Catches a floor that grows with the grains on it, and walls smeared out that end: a gate that
        slides in its plane, a plane that turns."""
        def square(half, x, z, tilt=0.0):
            u, w = np.array([math.cos(tilt), 0, math.sin(tilt)]), np.array([0, 1.0, 0])
            return np.array([x, 0, z]) + half * np.array([-u - w, u - w, u + w, w - u])

        frames, fan = [], np.array([[0, 1, 2], [0, 2, 3]])
        for k, half in enumerate((1.0, 3.0)):
            #                a floor                a gate               an end that turns        a floor that rises
            parts = [square(half, 0, 0), square(1, 2.0 * k, 5), square(half, 9, 0, 0.3 * k), square(half, 0, -4 + k)]
            name = os.path.join(self.folder, f"walls_{k}.vtp")
            write_vtp(name, np.concatenate(parts), {"wall": np.repeat(np.arange(4), 4).astype(np.uint32),
                                                    "unbounded": np.repeat([1, 0, 1, 1], 4).astype(np.uint32)},
                      np.concatenate([fan + 4 * j for j in range(4)]).astype(np.int32))
            frames.append(silt.read(name))
        planes = Planes()
        for frame in frames:
            planes.take(frame)
        for k, frame in enumerate(frames):
            points, triangles = planes.surface(frame)
            corners = points[triangles]
            areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
            middle = corners.mean(axis=1)
            for of, area in ((abs(middle[:, 2]) < 1e-6) & (abs(middle[:, 0]) < 4), 36), \
                    (middle[:, 2] > 4, 4), (middle[:, 0] > 4, (4, 36)[k]), (abs(middle[:, 2] + 4 - k) < 1e-6, 36):
                self.assertAlmostEqual(areas[of].sum(), area, 5)
        alone = Planes()
        alone.take(frames[0])
        self.assertEqual(len(alone.surface(frames[0])[1]), 8)

    @needs("pieces")
    def test_pieces_of_ranks(self):
        _, [whole] = figure_of(path("whole"), "--colour", "velocity")
        _, [pieces] = figure_of(path("pieces"), "--colour", "velocity")
        np.testing.assert_allclose(np.sort(pieces.bed.values), np.sort(whole.bed.values), rtol=1e-6)
        _, [by_rank] = figure_of(path("pieces"), "--colour", "rank")
        self.assertEqual(by_rank.bed.label, "rank")
        self.assertGreater(len(np.unique(by_rank.bed.values)), 1)
        self.refused("has no field 'rank'", "draw", path("whole"), "--colour", "rank", "-o", self.out)

    def test_movies(self):
        from PIL import Image

        gif = os.path.join(self.folder, "bed.gif")
        done = run("draw", path("grains"), "--colour", "velocity", "-o", gif, "--fps", 5)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with Image.open(gif) as movie:
            self.assertEqual((movie.n_frames, movie.info["duration"]), (3, 200))
            frames = []
            for k in range(3):
                movie.seek(k)
                frames.append(np.asarray(movie.convert("RGB"), float))
        self.assertTrue(all(np.abs(a - b).max() > 100 for a, b in zip(frames, frames[1:])), "frames are alike")
        frames = os.path.join(self.folder, "frame_%04d.png")
        self.assertEqual(run("draw", path("grains"), "-o", frames, "--every", 2).returncode, 0)
        self.assertEqual(sorted(n for n in os.listdir(self.folder) if n.startswith("frame")),
                         ["frame_0000.png", "frame_0001.png"])
        mp4 = os.path.join(self.folder, "bed.mp4")
        if shutil.which("ffmpeg"):
            self.assertEqual(run("draw", path("grains"), "-o", mp4).returncode, 0)
            self.assertGreater(os.path.getsize(mp4), 1000)
        else:
            self.refused("there is no ffmpeg", "draw", path("grains"), "-o", mp4)

    def test_refusals(self):
        self.refused("has no field 'charge'; it has: radius", "draw", path("grains"), "--colour", "charge", "-o", self.out)
        self.refused("cannot be read", "draw", path("nothing.vtp"), "-o", self.out)
        self.refused("cannot be written", "draw", path("grains"), "-o", os.path.join(self.folder, "no", "x.png"))
        self.refused("see --help", "draw", path("grains"))
        self.refused("must be an angle from 1 to 120", "draw", path("grains"), "--perspective", 170, "-o", self.out)
        self.refused("2 titles for 1 files", "draw", path("grains"), "--title", "a", "b", "-o", self.out)
        self.refused("at least 1", "draw", path("grains"), "--every", 0, "-o", self.out)
        if has("shapes"):
            self.refused("--names", "draw", path("shapes"), "--colour", "form", "--names", "a", "-o", self.out)
        self.refused("--names", "draw", path("grains"), "--colour", "radius", "--names", "a", "-o", self.out)
        self.refused("must be 2 numbers", "draw", path("grains"), "--range", "1", "-o", self.out)
        self.raises("has no option 'color_map'", drawing.draw, path("grains"), out=self.out, color_map="x")

    def test_from_python(self):
        drawing.draw(path("grains", "particles.pvd"), out=self.out, colour="velocity", cut=["y=0.006"], view="iso")
        self.assertGreater((colourful(picture(self.out)) > 0.15).mean(), 0.03)  # half of them are cut off


class Speed(unittest.TestCase):
    @needs("shapes")  # of the long tests, as this takes long
    def test_ten_thousand_spheres_and_a_thousand_bodies_in_seconds(self):
        """Catches bodies drawn point by point or patch by patch (half a minute and more)."""
        with tempfile.TemporaryDirectory() as folder:
            name, out = os.path.join(folder, "bed.vtp"), os.path.join(folder, "bed.png")
            places = np.stack(np.unravel_index(np.arange(10000), (20, 20, 25)), axis=1) * 2e-3
            write_vtp(name, places + rng.uniform(0, 2e-4, places.shape), {
                "radius": rng.uniform(8e-4, 1.1e-3, 10000).astype(np.float32), "id": np.arange(10000, dtype=np.uint64)})
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.assertEqual(run_apart("draw", name, "--colour", "id", "--view", "iso", "-o", out).returncode, 0)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            print(f"10 000 spheres: {seconds:.1f} s of processor time")
            self.assertLess(seconds, 15)

            form, facets = ball()
            pill = form / (np.abs(form) ** 4).sum(axis=1, keepdims=True) ** 0.25 * [4e-3, 4e-3, 2e-3]
            turns = np.linalg.qr(rng.normal(size=(1000, 3, 3)))[0]
            turns *= np.linalg.det(turns)[:, None, None]
            places = np.stack(np.unravel_index(np.arange(1000), (10, 10, 10)), axis=1) * 0.012  # [m]
            points = np.einsum("kij,pj->kpi", turns, pill) + places[:, None, :]
            triangles = facets + np.arange(1000)[:, None, None] * len(pill)
            write_vtp(name, points.reshape(-1, 3), {
                "form": np.repeat(np.arange(1000, dtype=np.uint32) % 2, len(pill)),
                "id": np.repeat(np.arange(1000, dtype=np.uint64), len(pill))}, triangles.reshape(-1, 3).astype(np.int32))
            self.assertEqual(run_apart("draw", name, "--colour", "form", "--names", "tablets,pills", "--view", "top",
                                 "-o", out).returncode, 0)
            last = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = last.ru_utime + last.ru_stime - after.ru_utime - after.ru_stime
            print(f"1000 super-ellipsoids: {seconds:.1f} s of processor time")
            self.assertLess(seconds, 20)
            # All bodies of the top layer of ten are seen; a cut that leaves none is a sentence.
            bed = Bed(name, None, view_axes("top"), None)
            canvas = Canvas([-0.01, 0.12, -0.01, 0.12], 500)
            canvas.draw_triangles(bed.places, bed.triangles, bed.normals, np.full((len(bed.places), 3), 0.5))
            x, y = (canvas.to_pixels(places[9::10].astype(float))[:, k].astype(int) for k in (0, 1))
            above = canvas.depth[y, x] / canvas.scale - 9 * 0.012  # [m] of the middles of the top layer
            self.assertTrue(((above > 1.9e-3) & (above < 7e-3)).all())
            done = run("draw", name, "--cut", "y=1", "-o", out)
            self.assertEqual(done.returncode, 2)
            self.assertIn("there is nothing to draw", done.stderr)


def write_lines(name, ends, fields):
    """Lines of two points of their own each, as silt writes them."""
    data = b""

    def array(called, values):
        nonlocal data
        offset, raw = len(data), values.tobytes()
        data += len(raw).to_bytes(8, "little") + raw
        kind = {"float64": "Float64", "float32": "Float32", "int32": "Int32"}[str(values.dtype)]
        return (f'<DataArray type="{kind}" Name="{called}" format="appended" '
                f'NumberOfComponents="{3 if values.ndim == 2 else 1}" offset="{offset}"/>')

    lines = len(ends) // 2
    body = (f'<PolyData><Piece NumberOfPoints="{len(ends)}" NumberOfLines="{lines}"><CellData>'
            + "".join(array(n, v) for n, v in fields.items()) + "</CellData><Points>" + array("Points", ends)
            + "</Points><Lines>" + array("connectivity", np.arange(len(ends), dtype=np.int32))
            + array("offsets", np.arange(2, len(ends) + 1, 2, dtype=np.int32)) + "</Lines></Piece></PolyData>")
    with open(name, "wb") as file:
        file.write(('<VTKFile type="PolyData" header_type="UInt64">' + body + '<AppendedData encoding="raw">_').encode()
                   + data + b"</AppendedData></VTKFile>")


class Captions(Refuses, unittest.TestCase):
    def test_captions(self):
        """Captions that are file names or times of 16 digits."""
        with tempfile.TemporaryDirectory() as folder:
            bodies = os.path.join(folder, "bodies_000012.vtp")
            lone = os.path.join(folder, "bodies.png")
            self.assertEqual(style.captions(None, [bodies]), ["step 12"])
            self.assertEqual(style.captions(None, [lone]), [""])
            self.assertEqual(style.captions(None, ["a/loose_bed.vtp", "end.vtp"]), ["loose bed", "end"])
            with open(os.path.join(folder, "bodies.pvd"), "w") as file:
                file.write('<VTKFile type="Collection"><Collection><DataSet timestep="0.004994545520361839" '
                           'part="0" file="bodies_000012.vtp"/></Collection></VTKFile>')
            self.assertEqual(style.captions(None, [bodies]), ["5.0 ms"])
            self.assertEqual(style.captions(["0.30000000000000004 s after, 2.5 kg"], [bodies]), ["0.3 s after, 2.5 kg"])
        self.assertEqual(style.spell_times([0, 0.5, 1.25]), ["0.00 s", "0.50 s", "1.25 s"])
        self.assertEqual(style.spell_times([0.1, 0.10002]), ["0.10000 s", "0.10002 s"])

    def test_numbers_at_a_colour_bar(self):
        """Catches numbers that run into each other, as 0.0025 0.0050 0.0075 did, and parts of whole numbers."""
        figure = style.plt.figure(figsize=(4, 1))
        bar = figure.colorbar(style.ScalarMappable(style.Normalize(0, 0.02)), orientation="horizontal",
                              cax=figure.add_axes([0.05, 0.6, 0.9, 0.2]))

        def labels():
            figure.canvas.draw()
            boxes = [one.get_window_extent() for one in bar.ax.get_xticklabels() if one.get_text()]
            return len(boxes), all(a.x1 < b.x0 for a, b in zip(boxes, boxes[1:]))

        self.assertFalse(labels()[1], "the numbers were to run into each other before")
        style.tick_apart(bar, figure)
        self.assertTrue(labels()[0] >= 3 and labels()[1])
        # Catches differences from an offset, "+2.93e2", in place of the numbers.
        for low, high in ((293.1, 293.2), (101325.001, 101325.003), (-1e5 - 2, -1e5)):
            offset = style.add_bar(figure, style.Normalize(low, high), style.COLOUR_MAP, "T [K]", [0.1, 0.6, 0.5, 0.2])
            numbers = [float(one.get_text().replace("\N{MINUS SIGN}", "-")) for one in offset.ax.get_xticklabels()
                       if one.get_text()]
            self.assertTrue(all(low - 1 < number < high + 1 for number in numbers) and len(numbers) > 1, numbers)
            self.assertEqual(offset.ax.get_xlabel(), "T [K]")
            offset.remove()
        bar.mappable.set_clim(0, 2)
        style.tick_apart(bar, figure, whole=True)
        self.assertTrue(all(float(one.get_text()) == int(float(one.get_text()))
                            for one in bar.ax.get_xticklabels() if one.get_text()))


class WallsAlone(unittest.TestCase):
    def test_planes_do_not_hide_what_is_behind_them(self):
        """Catches walls drawn as solid bodies: a plane in front of all else, and --walls-as without effect."""
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
        points = np.concatenate([np.insert(square, 1, 0, axis=1), np.insert(0.4 + 0.2 * square, 1, 1, axis=1)])
        triangles = np.array([(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)], np.int32)
        with tempfile.TemporaryDirectory() as folder:
            name, out = os.path.join(folder, "walls.vtp"), os.path.join(folder, "x.png")
            write_vtp(name, points, {"wall": np.repeat(np.arange(2), 4).astype(np.uint32),
                                     "unbounded": np.repeat([1, 0], 4).astype(np.uint32)}, triangles)
            shown = {}
            for style in (None, "glass", "solid", "edges"):
                drawing.draw(name, out=out, **({"walls_as": style} if style else {}))
                shown[style] = picture(out)
            self.assertTrue((shown[None] == shown["glass"]).all())
            dark = {style: (image.max(axis=2) < 0.4).mean() for style, image in shown.items()}
            self.assertGreater(dark["edges"], dark["solid"])  # the edges of the square behind
            self.assertFalse(any((colourful(image) > 0.15).any() for image in shown.values()))  # of bodies


    def test_a_cylinder_that_is_cut_along_its_axis_keeps_both_side_lines(self):
        """Catches the side line whose points are by rounding on the side that is left out."""
        turn = np.arange(64) * 2 * np.pi / 64
        rim = 0.04 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        points = np.concatenate([np.insert(rim, 2, z, axis=1) for z in (0, 0.3)])
        self.assertLess(abs(points[32, 1]), 1e-16)
        k = np.arange(64)
        right = np.roll(k, -1)
        triangles = np.concatenate([np.stack([k, right, k + 64], axis=1), np.stack([right, right + 64, k + 64], axis=1)])
        for words in ("y=0", "y>0", "y<0"):
            axes = view_axes("front")
            edges = Cut(words, axes).clip(drawing.wall_edges(points, triangles, axes[2]))
            sides = edges[np.ptp(edges[:, :, 2], axis=1) > 0.2]
            self.assertEqual(sorted(np.round(sides[:, 0, 0], 9)), [-0.04, 0.04], words)


class Tables(Refuses, unittest.TestCase):
    """`silt curves` and `silt cells`."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "x.png")
        self.kept, self.saves = [], (cells_module.save, curves_module.save)
        cells_module.save = curves_module.save = lambda figure, path: self.kept.append(figure)

    def tearDown(self):
        cells_module.save, curves_module.save = self.saves
        style.plt.close("all")
        shutil.rmtree(self.folder)

    def table(self, name, heading, *rows):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write("\n".join([heading, *(",".join(map(str, row)) for row in rows)]) + "\n")
        return path

    def figure(self, *arguments):
        options = parse([*map(str, arguments), "-o", "none"])
        options.run(options)
        return self.kept.pop()

    def test_a_picture_has_the_format_of_its_ending(self):
        """Catches a picture in PNG under the name of another format."""
        cells_module.save, curves_module.save = self.saves
        table = self.table("t.csv", "time [s],y [m]", (0, 1), (1, 2))
        for ending, first in ((".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml"), ("", b"\x89PNG")):
            out = os.path.join(self.folder, "c" + ending)
            options = parse(["curves", table, "--x", "time", "--y", "y", "-o", out])
            options.run(options)
            with open(out, "rb") as file:
                self.assertEqual(file.read(len(first)), first)
        self.refused("pictures have the endings", "curves", table, "--x", "time", "--y", "y", "-o", self.out[:-3] + "xyz")
        self.refused("it is a folder", "curves", table, "--x", "time", "--y", "y", "-o", self.folder)

    def test_a_layer_of_a_grid_in_space(self):
        """Catches a thin axis taken for one of the picture, blank cells drawn."""
        layer = self.table("layer.csv", "x [m],y [m],z [m],solid fraction [-],speed [m/s]",
                           *((k % 2, 0.5, k // 2, f"{0.1 * k:g}", k) for k in range(6)))
        name, values, bounds = cells_module.read_cells(layer, "speed", "solid fraction=0.15")
        self.assertEqual((name, values.shape, bounds), ("speed [m/s]", (3, 2), (-0.5, 1.5, -0.5, 2.5)))
        self.assertEqual((np.isnan(values).sum(), values[2, 1]), (2, 5))
        self.assertEqual(cells_module.read_cells(layer, "solid", "spe=1")[0], "solid fraction [-]")
        shown = np.array([[0, 1, 1, 0], [1, 1, 1, 1], [0, 0, 1, 0], [1, 0, 0, 0]], bool)
        self.assertEqual(np.argwhere(cells_module.sticks_out(shown)).tolist(), [[1, 0], [1, 3], [2, 2], [3, 0]])
        # Lines of walls, in the plane of the cells and not beside it.
        walls = os.path.join(self.folder, "walls.vtp")
        write_vtp(walls, np.array([(0, 0, 0), (0, 1, 0), (2, 1, 2), (9, 2, 0), (9, 3, 0), (9, 2, 2)], float), {},
                  np.array([(0, 1, 2), (3, 4, 5)], np.int32))
        ends = cells_module.section(layer, walls)
        np.testing.assert_allclose(np.sort(ends, axis=1), [[[0, 0], [1, 1]]], atol=1e-6)
        [_, line] = self.figure("cells", layer, "--value", "speed", "--walls", walls).axes[0].collections
        np.testing.assert_allclose(line.get_segments(), ends)
        self.refused("does not say where its plane lies", "cells", self.table("p.csv", "x [m],z [m],u", (0, 0, 1), (0, 1, 1),
                     (1, 0, 1), (1, 1, 2)), "--value", "u", "--walls", walls, "-o", self.out)
        self.refused("a column and a number", "cells", layer, "--value", "speed", "--least", "speed", "-o", self.out)
        self.refused("has no column 'heat'", "cells", layer, "--value", "heat", "-o", self.out)

    def test_a_colour_bar_beside_a_scale_bar(self):
        """Catches numbers that run into it or out of the picture, and a common factor under the label.
        Narrow panels, long numbers, tiny values, a long label."""
        for low, high, name in ((0, 1e-6, "stress of the contacts over that of the kinetic part [Pa]"),
                                (292.951, 292.964, "temperature [K]"), (-1.5e7, 2.5e7, "p [Pa]"),
                                (-0.00051, -0.00012, "v [m/s]")):
            for across, up in ((3, 3), (2, 40), (60, 3)):
                count = across * up
                path = self.table("cells.csv", f"x [m],z [m],{name}",
                                  *((1e-3 * (k % across), 1e-3 * (k // across), repr(low + k / (count - 1) * (high - low)))
                                    for k in range(count)))
                figure = self.figure("cells", path, "--value", name)
                figure.canvas.draw()
                boxes = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in figure.axes]
                words = f"{name}, {across} x {up} cells"
                self.assertFalse(any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k]), words)
                self.assertTrue(boxes[-1].x1 <= figure.bbox.x1 and boxes[-1].x0 >= 0, words)
                factor = figure.axes[-1].xaxis.get_offset_text()
                self.assertFalse(factor.get_visible() and factor.get_text(), words)
                style.plt.close(figure)

    def test_numbers_at_axes_have_no_offset(self):
        """Catches 0.1 and 0.2 beside "+2.93e2"."""
        table = self.table("t.csv", "time [s],T [K]", (0, 293.1), (1, 293.1002), (2, 293.1001))
        figure = self.figure("curves", table, "--x", "time", "--y", "T")
        figure.canvas.draw()
        axis = figure.axes[0].yaxis
        self.assertEqual(axis.get_offset_text().get_text(), "")
        self.assertTrue(all(one.get_text().startswith("293.") for one in axis.get_ticklabels()))

    def test_names_of_axes_and_marks(self):
        """Catches "to [m]" with 0.0025 for sizes, numbers in m beside "mm", and few points without marks."""
        rows = [(10 ** (-6 + 0.15 * k), k / 35) for k in range(36)]
        sizes = self.table("sizes.csv", "to [m],finer [-],area [m2]", *((*row, 1) for row in rows))
        [panel] = self.figure("curves", sizes, "--x", "to", "--y", "finer", "--x-label", "size [mm]",
                              "--y-label", "finer [%]").axes
        self.assertEqual((panel.get_xlabel(), panel.get_ylabel()), ("size [mm]", "finer [%]"))
        np.testing.assert_allclose(panel.lines[0].get_xydata(), np.array(rows) * [1e3, 100])
        self.assertEqual(panel.lines[0].get_marker(), "o")
        [panel] = self.figure("curves", sizes, "--x", "to", "--y", "finer", "--x-label", "size", "--log", "x").axes
        self.assertEqual((panel.get_xlabel(), panel.lines[0].get_marker()), ("size [m]", "None"))
        for unit, words, factor in (("kg", "mass [g]", 1e3), ("ms", "t [s]", 1e-3), ("m2", "A [mm2]", 1), ("m/s", "v [mm/s]", 1e3),
                                    ("J", "E", 1), ("s", "t [min]", 1), ("Pa", "p [kPa]", 1e-3), ("", "x [m]", 1)):
            self.assertAlmostEqual(curves_module.factor_to(unit, words), factor, msg=words)

    def lines(self, *arguments):
        figure = self.figure("curves", *arguments)
        return [[(one.get_label(), one.get_color(), one.get_linestyle(), one.get_xydata().tolist())
                 for one in panel.lines] for panel in figure.axes]

    def test_curves_of_several_files(self):
        """Catches rows of one file over the other's x, colours that say nothing, and units that are mixed."""
        a = self.table("loose/energy.csv", "time [s],kinetic [J],heat [J],T [K]", (0, 3, 1, 300), (1, 2, 2, 301))
        b = self.table("dense/energy.csv", "time [s],kinetic [J],heat [J],T [K]", (0, 5, 0, 300), (3, 4, 1, 310),
                       (4, 3, 2, 320))
        ms = self.table("c.csv", "time [ms],kinetic [J]", (0, 1), (1, 2))
        [[of_a, of_b]] = self.lines(a, b, "--x", "time", "--y", "kinetic")
        self.assertEqual((of_a[0], of_b[0]), ("loose", "dense"))
        self.assertNotEqual(of_a[1], of_b[1])
        self.assertEqual((of_a[3], of_b[3]), ([[0, 3], [1, 2]], [[0, 5], [3, 4], [4, 3]]))
        first, second = self.lines(a, b, "--x", "time", "--y", "kinetic,heat,T", "--labels", "wet", "dry")
        self.assertEqual([one[0] for one in first], ["wet: kinetic", "wet: heat", "dry: kinetic", "dry: heat"])
        self.assertEqual([one[0] for one in second], ["wet", "dry"])
        self.assertTrue(first[0][1] == first[1][1] == second[0][1] != first[2][1] and first[0][2] != first[1][2],
                        "a colour a file, a style a column")
        full = self.table("full.csv", "x,a,b,c", *[(k, k % 2, 1 - k % 2, 0.5) for k in range(60)])
        figure = self.figure("curves", full, "--x", "x", "--y", "a,b,c")
        [panel] = figure.axes
        figure.canvas.draw()
        self.assertGreaterEqual(panel.get_legend().get_window_extent().y0, panel.bbox.y1, "a legend hides curves")
        for label, shown in (("energy", "energy [J]"), ("energy [kJ]", "energy [kJ]")):
            [panel] = self.figure("curves", a, "--x", "time", "--y", "kinetic,heat", "--y-label", label).axes
            self.assertEqual(panel.get_ylabel(), shown)
        [alone] = self.lines(a, "--x", "time", "--y", "kinetic,heat")
        self.assertEqual([one[0] for one in alone], ["kinetic", "heat"])
        self.assertTrue(alone[0][1] != alone[1][1] and alone[0][2] == alone[1][2] == "-", "a colour a column")
        self.assertEqual(curves_module.file_words(["a/x_1.csv", "b/y.csv"]), ["x 1", "y"])
        self.refused("has 'time [ms]' where file", "curves", a, ms, "--x", "time", "--y", "kinetic", "-o", self.out)
        long = self.table("long.csv", "time [s],surface at 0.6 m [m],x of box [m],x of lid [m]", (0, 1, 2, 5), (1, 2, 3, 6))
        [[one, marks, _]] = self.lines(long, "--x", "ti", "--y", "surface", "--marks", "x_of_box")
        self.assertEqual((one[3], marks[3]), ([[0, 1], [1, 2]], [[0, 2], [1, 3]]))
        self.refused("has 2 columns that begin with 'x of': x of box [m], x of lid [m]", "curves", long, "--x", "time",
                     "--y", "x of", "-o", self.out)
        self.refused(f"file '{ms}' has no column 'heat'", "curves", a, ms, "--x", "time", "--y", "heat", "-o", self.out)
        self.refused("1 labels for 2 files", "curves", a, b, "--x", "time", "--y", "heat", "--labels", "q", "-o", self.out)
        self.refused("has words, no numbers", "curves", self.table("w.csv", "a,b", (1, "x"), (2, "y")),
                     "--x", "a", "--y", "b", "-o", self.out)
        done = run_apart("curves", a, b, "--x", "time", "--y", "kinetic,T", "-o", self.out)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertGreater(np.abs(1 - picture(self.out)).mean(), 0.01)


class Scripts(unittest.TestCase):
    def test_the_sentence_where_numpy_is_missing(self):
        from scenes import PACKAGE

        done = subprocess.run([os.sys.executable, "-S", "-E", "-c",
                               f"import sys; sys.path.insert(0, {PACKAGE!r})\nimport silt\ntry:\n import silt.drawing\n"
                               "except ImportError as e:\n print(e)"], capture_output=True, text=True)
        self.assertIn("has no numpy and no matplotlib; ", done.stdout)
        done = subprocess.run([os.sys.executable, "-S", "-E", "-c", f"import sys; sys.path.insert(0, {PACKAGE!r})\n"
                               "import silt\nsilt.open('x.pvd')"], capture_output=True, text=True)
        last = done.stderr.strip().splitlines()[-1]
        self.assertTrue(last.startswith("ImportError: silt: ") and " has no numpy; " in last, done.stderr)


if __name__ == "__main__":
    unittest.main()
