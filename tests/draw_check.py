#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""examples/support/draw.py as a user runs it, and its canvas against a plain one.

Each check names the wrong picture that it catches. Exit status 77: this Python has no numpy or
matplotlib; only the sentence that says so has been looked at.
"""
import os
import resource
import subprocess
import sys
import tempfile

SUPPORT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "examples", "support")
DRAW = os.path.join(SUPPORT, "draw.py")
failed = 0


def check(holds, words):
    global failed
    if not holds:
        failed += 1
        print("FAIL:", words)


def run(*arguments, python=(sys.executable,)):
    return subprocess.run([*python, DRAW, *arguments], capture_output=True, text=True)


def refused(words, *arguments):
    """Status 2 and one sentence with these words on stderr."""
    done = run(*arguments)
    check(done.returncode == 2 and words in done.stderr and done.stderr.count("\n") == 1,
          f"draw.py {' '.join(arguments)}: status {done.returncode}, {done.stderr!r}")


# Catches a raw ModuleNotFoundError: without site packages there is no numpy.
bare = run("spheres", "x.vtp", "--out", "x.png", python=(sys.executable, "-S", "-E"))
check(bare.returncode == 2 and "has no numpy and no matplotlib; " in bare.stderr and
      ("apt-get install python3-numpy python3-matplotlib" in bare.stderr or
       "/usr/bin/python3, which has them" in bare.stderr) and bare.stderr.count("\n") == 1,
      f"without numpy: status {bare.returncode}, {bare.stderr!r}")

sys.path.insert(0, SUPPORT)
try:
    import matplotlib  # noqa: F401
    import numpy as np
except ModuleNotFoundError:
    sys.exit(1 if failed else 77)
import draw  # noqa: E402
from canvas import Canvas  # noqa: E402

rng = np.random.default_rng(1)
VTK = {"float64": "Float64", "float32": "Float32", "uint32": "UInt32"}


def write_vtp(path, points, triangles=(), lines=False, **fields):
    """As silt writes them: appended raw data. Lines: of two points each, the fields are theirs."""
    data = b""

    def array(name, values):
        nonlocal data
        offset, raw = len(data), values.tobytes()
        data += len(raw).to_bytes(8, "little") + raw
        return (f'<DataArray type="{VTK[str(values.dtype)]}" Name="{name}" format="appended" '
                f'NumberOfComponents="{values[0].size}" offset="{offset}"/>')

    body = "<Points>" + array("Points", np.asarray(points, float)) + "</Points>"
    kind = "CellData" if lines else "PointData"
    body += f"<{kind}>" + "".join(array(name, v) for name, v in fields.items()) + f"</{kind}>"
    if lines:
        body += "<Lines>" + array("connectivity", np.arange(len(points), dtype=np.uint32)) + "</Lines>"
    if len(triangles):
        corners = np.asarray(triangles, np.uint32).reshape(-1)
        body += "<Polys>" + array("connectivity", corners) + "</Polys>"
    with open(path, "wb") as file:
        file.write(('<VTKFile type="PolyData" header_type="UInt64"><PolyData><Piece>' + body +
                    '</Piece></PolyData><AppendedData encoding="raw">_').encode() + data +
                   b"</AppendedData></VTKFile>")


def ball(around=24, down=16):
    """A sphere's points and triangles, which run anticlockwise as seen from outside."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(down + 1) * np.pi / down)
    points = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=2)
    k = np.arange(around * down).reshape(down, around)
    right = np.roll(k, -1, axis=1)
    triangles = np.stack([k, k + around, right, right, k + around, right + around], axis=2)
    return points.reshape(-1, 3), triangles.reshape(-1, 3)


# Catches bodies drawn point by point (30 s of processor time and more), bodies left out, and those
# behind others that show: from above the top layer of ten is seen.
with tempfile.TemporaryDirectory() as folder:
    form, facets = ball()
    pill = form / (np.abs(form) ** 4).sum(axis=1, keepdims=True) ** 0.25 * [4e-3, 4e-3, 2e-3]
    turns = np.linalg.qr(rng.normal(size=(1000, 3, 3)))[0]
    turns *= np.linalg.det(turns)[:, None, None]
    places = np.stack(np.unravel_index(np.arange(1000), (10, 10, 10)), axis=1) * 0.012  # [m]
    points = np.einsum("kij,pj->kpi", turns, pill) + places[:, None, :]
    triangles = facets + np.arange(1000)[:, None, None] * len(pill)
    kind = np.repeat(np.arange(1000, dtype=np.uint32) % 2, len(pill))
    bodies = os.path.join(folder, "bodies_000012.vtp")
    write_vtp(bodies, points.reshape(-1, 3), triangles.reshape(-1, 3), form=kind,
              id=np.repeat(np.arange(1000, dtype=np.uint32), len(pill)))
    picture = os.path.join(folder, "bodies.png")
    done = run("spheres", bodies, "--colour", "form", "--names", "tablets,pills", "--view", "top",
               "--out", picture)
    check(done.returncode == 0, f"1000 super-ellipsoids: {done.stderr}")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = seconds.ru_utime + seconds.ru_stime
    print(f"1000 super-ellipsoids: {seconds:.1f} s of processor time")
    check(seconds < 20, f"1000 super-ellipsoids took {seconds:.1f} s of processor time")
    bed = draw.Bed(bodies, None, draw.view_axes("top"), None)
    canvas = Canvas([-0.01, 0.12, -0.01, 0.12], 500)
    canvas.draw_triangles(bed.places, bed.triangles, bed.normals, np.full((len(bed.places), 3), 0.5))
    x, y = (canvas.to_pixels(places[9::10])[:, k].astype(int) for k in (0, 1))
    above = canvas.depth[y, x] / canvas.scale - 9 * 0.012  # [m] of the middles of the top layer
    check(((above > 1.9e-3) & (above < 7e-3)).all(), "not all bodies of the top layer are seen")
    done = run("spheres", bodies, "--colour", "form", "--cut", "y=1", "--walls", bodies, "--out",
               picture)
    check("Traceback" not in done.stderr, f"a cut that leaves no body: {done.stderr}")
    refused("--names", "spheres", bodies, "--colour", "form", "--names", "tablets", "--out", picture)

    # Captions that are file names or times of 16 digits.
    check(draw.captions(None, [bodies]) == ["step 12"], "a number in a file's name is its step")
    check(draw.captions(None, [picture]) == [""], "a lone picture needs no name")
    check(draw.captions(None, ["a/loose_bed.vtp", "end.vtp"]) == ["loose bed", "end"],
          "several files are told apart by their names")
    with open(os.path.join(folder, "bodies.pvd"), "w") as file:
        file.write('<VTKFile type="Collection"><Collection><DataSet timestep="0.004994545520361839" '
                   'part="0" file="bodies_000012.vtp"/></Collection></VTKFile>')
    check(draw.captions(None, [bodies]) == ["5.0 ms"], f"{draw.captions(None, [bodies])}, not 5.0 ms")
    check(draw.spell_times([0, 0.5, 1.25]) == ["0.00 s", "0.50 s", "1.25 s"],
          f"times in one unit: {draw.spell_times([0, 0.5, 1.25])}")
    check(draw.spell_times([0.1, 0.10002]) == ["0.10000 s", "0.10002 s"], "times are told apart")
    check(draw.captions(["0.30000000000000004 s after, 2.5 kg"], [bodies]) ==
          ["0.3 s after, 2.5 kg"], "numbers of 17 digits in a title")
    refused("2 titles for 1 files", "spheres", bodies, "--title", "a", "b", "--out", picture)

# Triangles in any order, slivers too, some beyond the picture, against one after the other at the
# middle of every pixel. Catches gaps between neighbours, wrong depths, and triangles skipped as hidden
# that are not.
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
    z = np.where((v >= 0) & (w >= 0) & (v + w <= 1), (1 - v - w) * a[2] + v * b[2] + w * c[2], -np.inf)
    depth = np.maximum(depth, z)
both = np.isfinite(depth) & np.isfinite(canvas.depth)
check((np.isfinite(depth) != np.isfinite(canvas.depth)).sum() <= 4, "pixels covered differ")
check((np.abs(depth[both] - canvas.depth[both]) > 0.01).sum() <= 4,
      "depths differ from those of one triangle after the other")
check(((owner >= 0) == np.isfinite(canvas.depth)).all(), "a pixel has a depth and no triangle")

# A large triangle whose box has its corners behind others, which are nearer, is seen between them.
near = np.array([[-60, -60, 100], [100, -60, 100], [20, 100, 100]], float)
corners = np.concatenate([[near + [dx, dy, 0] for dx in (0, 160) for dy in (0, 170)],
                          [[[10, 10, 0], [190, 10, 0], [100, 190, 0]]]])
canvas = Canvas([0, 100, 0, 100], 100)
owner = canvas.front_triangles(corners, canvas.depth, portion=1000)
check(owner[100, 100] == 4, "a large triangle between nearer ones is taken for hidden")

# A sphere of triangles looks like a sphere: catches normals turned inside out or not interpolated.
form, facets = ball(96, 64)
pictures = []
for draw_it in (lambda c: c.draw_spheres(np.zeros((1, 3)), np.ones(1), np.full((1, 3), 0.6)),
                lambda c: c.draw_triangles(form, facets, form[facets], np.full((len(form), 3), 0.6))):
    canvas = Canvas([-1.2, 1.2, -1.2, 1.2], 150)
    draw_it(canvas)
    pictures.append((canvas.image, np.isfinite(canvas.depth)))
middle = np.hypot(*np.meshgrid(*[np.linspace(-1.2, 1.2, 300)] * 2)) < 0.85
check((pictures[0][1] != pictures[1][1]).mean() < 0.005, "the outlines of both spheres differ")
difference = np.abs(pictures[0][0] - pictures[1][0])[middle].mean()
check(difference < 0.04, f"the shades of both spheres differ by {difference:.3f}")

# Walls: in front of grains they leave them as they are, beside grains they tint, and of two the
# farther shows. Catches walls that hide or veil grains.
def square(z, half, slope=0.0):
    p = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    p[:, 2] += slope * p[:, 0]
    return p[[[0, 1, 2], [0, 2, 3]]]


for wall in (square(5, 1.1), square(-5, 1.1)):
    canvas = Canvas([-1.2, 1.2, -1.2, 1.2], 150)
    canvas.draw_spheres(np.zeros((1, 3)), np.full(1, 0.5), np.full((1, 3), 0.6))
    before, grain = canvas.image.copy(), np.isfinite(canvas.depth)
    canvas.draw_walls(wall)
    check((canvas.image[grain] == before[grain]).all(), "a wall changes what is seen of a grain")
    tinted = (canvas.image < 0.99).any(axis=2) & ~grain
    check(abs(tinted.mean() + grain.mean() - (1.1 / 1.2) ** 2) < 0.01, "a wall is not all there")
one, two = (Canvas([-1.2, 1.2, -1.2, 1.2], 50) for _ in range(2))
one.draw_walls(square(-5, 1.1, slope=1.0))
two.draw_walls(np.concatenate([square(5, 1.1), square(-5, 1.1, slope=1.0)]))
check((one.image == two.image).all(), "the nearer of two walls is seen")

# A cut takes what is in front of it from walls too: catches back walls that go with the front ones.
cut = draw.Cut("y=0.25", draw.view_axes("front"))
wall = np.array([[[0, 0, 0], [0, 1, 0], [0, 1, 1]], [[0, 0, 0], [0, 1, 1], [0, 0, 1]]], float)
kept = cut.clip_triangles(wall)
area = np.linalg.norm(np.cross(kept[:, 1] - kept[:, 0], kept[:, 2] - kept[:, 0]), axis=1).sum() / 2
check(abs(area - 0.75) < 1e-12 and kept[:, :, 1].min() > 0.25 - 1e-12,
      f"a wall cut at a quarter has an area of {area}, not 0.75")

# Force chains: catches lines left out of a slab or drawn in another place, and pulls drawn as
# pushes: of four contacts across the picture, two lie in the slab and press.
with tempfile.TemporaryDirectory() as folder:
    path, out = os.path.join(folder, "contacts.vtp"), os.path.join(folder, "chains.png")
    ends = [[x, y, z] for y, z in ((0, 0), (0, 1), (0.5, 2), (0, 3)) for x in (0, 3)]
    write_vtp(path, ends, lines=True, normal_force=np.array([1, 2, 3, -1], np.float32))
    for slab, heights in (("y=-0.1,0.1", [0, 1]), ("y=0.4,0.6", [2]), (None, [0, 1, 2])):
        lines, force = draw.pressing_lines(path, slab)
        check(lines[:, :, 2].tolist() == [[z, z] for z in heights] and
              force.tolist() == [z + 1 for z in heights], f"chains in {slab}: {lines}")
    done = run("chains", path, "--slab", "y=-0.1,0.1", "--out", out)
    check(done.returncode == 0 and os.path.getsize(out) > 1000, f"draw.py chains: {done.stderr}")
    refused("no contacts that press", "chains", path, "--slab", "y=7,8", "--out", out)
    refused("an axis and two places", "chains", path, "--slab", "w=7,8", "--out", out)

# A layer of a grid in space: catches a thin axis taken for one of the picture, blank cells drawn.
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "layer.csv")
    with open(path, "w") as file:
        file.write("x [m],y [m],z [m],solid fraction [-],speed [m/s]\n")
        for k in range(6):
            file.write(f"{k % 2},0.5,{k // 2},{0.1 * k:g},{k}\n")
    name, values, bounds = draw.read_cells(path, "speed", "solid fraction=0.15")
    check(name == "speed [m/s]" and values.shape == (3, 2) and bounds == (-0.5, 1.5, -0.5, 2.5),
          "a layer of a grid is not read as x and z")
    check(np.isnan(values).sum() == 2 and values[2, 1] == 5, "cells with too little are not left out")
    refused("a column and a number", "cells", path, "--value", "speed", "--least", "speed",
            "--out", os.path.join(folder, "x.png"))

# Catches numbers at a colour bar that run into each other, as 0.0025 0.0050 0.0075 did.
figure = draw.plt.figure(figsize=(4, 1))
bar = figure.colorbar(draw.ScalarMappable(draw.Normalize(0, 0.02)), orientation="horizontal",
                      cax=figure.add_axes([0.05, 0.6, 0.9, 0.2]))


def labels():
    figure.canvas.draw()
    boxes = [one.get_window_extent() for one in bar.ax.get_xticklabels() if one.get_text()]
    return len(boxes), all(a.x1 < b.x0 for a, b in zip(boxes, boxes[1:]))


check(not labels()[1], "the colour bar's numbers were to run into each other before")
draw.tick_apart(bar, figure)
check(labels()[0] >= 3 and labels()[1], f"numbers at a colour bar: {labels()}")
bar.mappable.set_clim(0, 2)  # catches 0.25, 0.5, ... of a count
draw.tick_apart(bar, figure, whole=True)
check(all(float(one.get_text()) == int(float(one.get_text()))
          for one in bar.ax.get_xticklabels() if one.get_text()), "parts of whole numbers at a colour bar")

# A colour bar beside a scale bar: catches numbers that run into it or out of the picture, and a
# common factor under the label. Narrow panels, long numbers, tiny values, a long label.
with tempfile.TemporaryDirectory() as folder:
    kept = []
    draw.save, save = (lambda figure, path: kept.append(figure)), draw.save
    for low, high, name in ((0, 1e-6, "stress of the contacts over that of the kinetic part [Pa]"),
                            (292.951, 292.964, "temperature [K]"), (-1.5e7, 2.5e7, "p [Pa]"),
                            (-0.00051, -0.00012, "v [m/s]")):
        for across, up in ((3, 3), (2, 40), (60, 3)):
            path = os.path.join(folder, "cells.csv")
            with open(path, "w") as file:
                file.write(f"x [m],z [m],{name}\n")
                for k in range(across * up):
                    part = k / (across * up - 1)
                    file.write(f"{1e-3 * (k % across)},{1e-3 * (k // across)},"
                               f"{low + part * (high - low)!r}\n")
            draw.draw_cells(draw.parse(["cells", path, "--value", name, "--out", "none"]))
            figure = kept.pop()
            figure.canvas.draw()
            boxes = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in figure.axes]
            words = f"{name}, {across} x {up} cells"
            check(not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k]),
                  f"parts of a picture overlap: {words}")
            check(boxes[-1].x1 <= figure.bbox.x1 and boxes[-1].x0 >= 0,
                  f"a colour bar's numbers leave the picture: {words}")
            check(not figure.axes[-1].xaxis.get_offset_text().get_visible() or
                  not figure.axes[-1].xaxis.get_offset_text().get_text(), f"a factor: {words}")

    # Curves of several files: catches rows of one file over the other's x, colours that say nothing,
    # and units that are mixed.
    def table(words, *rows):
        path = os.path.join(folder, words[0])
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write("\n".join([words[1], *(",".join(map(str, row)) for row in rows)]) + "\n")
        return path

    a = table(("loose/energy.csv", "time [s],kinetic [J],heat [J],T [K]"), (0, 3, 1, 300), (1, 2, 2, 301))
    b = table(("dense/energy.csv", "time [s],kinetic [J],heat [J],T [K]"), (0, 5, 0, 300), (3, 4, 1, 310),
              (4, 3, 2, 320))
    ms = table(("c.csv", "time [ms],kinetic [J]"), (0, 1), (1, 2))

    def lines(*arguments):
        draw.draw_curves(draw.parse(["curves", *arguments, "--out", "none"]))
        return [[(one.get_label(), one.get_color(), one.get_linestyle(), one.get_xydata().tolist())
                 for one in panel.lines] for panel in kept.pop().axes]

    [[of_a, of_b]] = lines(a, b, "--x", "time", "--y", "kinetic")
    check(of_a[0] == "loose" and of_b[0] == "dense" and of_a[1] != of_b[1], f"legend: {of_a}, {of_b}")
    check(of_a[3] == [[0, 3], [1, 2]] and of_b[3] == [[0, 5], [3, 4], [4, 3]], "values of two files")
    first, second = lines(a, b, "--x", "time", "--y", "kinetic,heat,T", "--labels", "wet", "dry")
    check([one[0] for one in first] == ["wet: kinetic", "wet: heat", "dry: kinetic", "dry: heat"] and
          [one[0] for one in second] == ["wet", "dry"], f"legend: {first}")
    check(first[0][1] == first[1][1] == second[0][1] != first[2][1] and first[0][2] != first[1][2],
          "a colour a file, a style a column")
    # A legend that hides a curve: in a picture full of lines it stands above.
    full = table(("full.csv", "x,a,b,c"), *[(k, k % 2, 1 - k % 2, 0.5) for k in range(60)])
    draw.draw_curves(draw.parse(["curves", full, "--x", "x", "--y", "a,b,c", "--out", "none"]))
    [panel] = kept[-1].axes
    kept.pop().canvas.draw()
    check(panel.get_legend().get_window_extent().y0 >= panel.bbox.y1, "a legend hides curves")
    [alone] = lines(a, "--x", "time", "--y", "kinetic,heat")
    check([one[0] for one in alone] == ["kinetic", "heat"] and alone[0][1] != alone[1][1] and
          alone[0][2] == alone[1][2] == "-", "one file: a colour a column, as before")
    check(draw.file_words(["a/x_1.csv", "b/y.csv"]) == ["x 1", "y"], "files of different names")
    draw.save = save
    out = os.path.join(folder, "x.png")
    refused("has 'time [ms]' where file", "curves", a, ms, "--x", "time", "--y", "kinetic", "--out", out)
    refused(f"file '{ms}' has no column 'heat'", "curves", a, ms, "--x", "time", "--y", "heat", "--out", out)
    refused("1 labels for 2 files", "curves", a, b, "--x", "time", "--y", "heat", "--labels", "q", "--out", out)
    done = run("curves", a, b, "--x", "time", "--y", "kinetic,T", "--out", out)
    check(done.returncode == 0 and os.path.getsize(out) > 1000, f"draw.py curves: {done.stderr}")

print(f"draw.py: {failed} problems")
sys.exit(1 if failed else 0)
