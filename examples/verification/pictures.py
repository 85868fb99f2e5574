#!/usr/bin/python3
# silt - BSD-3-Clause, see LICENSE
"""The pictures of the verification gallery, from the tables that the program wrote into a folder.

  pictures.py out/verification

Lines are references in closed form or integrated apart, open symbols are published points
(reference/published.csv), filled symbols are silt. A wrong argument or file ends in one sentence on
stderr and exit status 2.
"""

import sys

from panels import COLOURS, Error, Folder, legend, line, name_axes, points, sheet, silt
import numpy as np

KHARAZ = "Kharaz 2001"
DEM = "Chung and Ooi 2011 (DEM)"
FEM = "finite elements"


# ------------------------------------------------------------------------- head-on impacts


def draw_elastic(folder, number, materials, title, reference):
    figure, axes = sheet(2, title)
    for (name, words), colour, marker in zip(materials, COLOURS, "os"):
        t, d, f, by_time, by_overlap = folder.columns(
            f"chung_ooi_{number}_{name}", "time", "overlap", "force",
            "force by Hertz at this time", "force by Hertz at this overlap")
        order = np.argsort(d)
        line(axes[0], t, by_time, "Hertz" if colour == COLOURS[0] else None)
        line(axes[1], d[order], by_overlap[order], "Hertz" if colour == COLOURS[0] else None)
        silt(axes[0], t, f, colour, f"silt, {words}", marker, 2)
        silt(axes[1], d, f, colour, f"silt, {words}", marker, 2)
    points(axes[0], f"chung_ooi_{number} force", f"{DEM} {reference}", "Chung and Ooi, DEM")
    name_axes(axes[0], "time since touch [µs]", "normal force [kN]")
    name_axes(axes[1], "overlap [µm]", "normal force [kN]")
    axes[0].set_ylim(0, 1.3 * axes[0].dataLim.ymax)
    legend(axes[0], ncol=2, loc="upper center")
    legend(axes[1])
    folder.save(figure, f"chung_ooi_{number}")


def both_ends(axes):
    """An axis for each end of contact, with the law's name in the tables."""
    for axis, law, words in zip(axes, ["cut_at_zero_force", "to_zero_overlap"],
                                ["contact ends at zero force", "contact ends at zero overlap"]):
        yield axis, law
        axis.set_title(words, fontsize=10)
        legend(axis)


def draw_restitutions(folder):
    figure, axes = sheet(2, "Test 3: head-on on a plane, 3.9 m/s")
    for axis, law in both_ends(axes):
        e, oxide, iron = folder.columns("chung_ooi_3_" + law, "restitution given", "aluminium oxide",
                                        "cast iron")
        line(axis, [0, 1], [0, 1], "as given")
        silt(axis, e, oxide, COLOURS[0], "silt, aluminium oxide")
        axis.plot(e, iron, "s", mfc="none", mec=COLOURS[5], ms=8, label="silt, cast iron", zorder=4)
        name_axes(axis, "restitution given [-]", "restitution found [-]")
    folder.save(figure, "chung_ooi_3")


def draw_steps(folder):
    figure, axes = sheet(2, "Restitution over the time step, touch at the worst place within a step")
    for axis, law in both_ends(axes):
        n, e, error, bound = folder.columns("restitution_" + law, "steps a contact", "restitution",
                                            "error of restitution", "bound")
        for value, colour, marker in zip([1, 0.9, 0.5, 0.1], COLOURS, "os^D"):
            at = np.isclose(e, value)
            line(axis, n[at], bound[at], None, ":", colour)
            axis.plot(n[at], np.abs(error[at]), marker + "-", color=colour, ms=5, lw=0.8,
                      label=f"e = {value:g}")
        line(axis, [], [], "bound 2πζ/n + 1.9/n²", ":", "0.3")
        axis.set(xscale="log", yscale="log")
        axis.set_xticks([10, 20, 50, 100, 200], ["10", "20", "50", "100", "200"])
        axis.minorticks_off()
        name_axes(axis, "steps a contact [-]", "relative error of the restitution [-]")
    folder.save(figure, "restitution")


def draw_sizes(folder):
    figure, axes = sheet(2, "Unequal spheres, softened moduli")
    ratio, given, error = folder.columns("size_ratio", "size ratio", "restitution given", "error")
    for value, colour, marker in zip([0.8, 0.5], COLOURS, "os"):
        at = np.isclose(given, value)
        silt(axes[0], ratio[at], 100 * error[at], colour, f"silt, e = {value:g}", marker)
    line(axes[0], [1, 100], [0.1, 0.1], "limit", ":")
    line(axes[0], [1, 100], [-0.1, -0.1], None, ":")
    line(axes[0], [1, 100], [0, 0], "exact")
    axes[0].set_xscale("log")
    name_axes(axes[0], "ratio of the radii [-]", "error of the restitution [%]")
    legend(axes[0], loc="upper right", bbox_to_anchor=(1, 0.9))
    size, closed, found, times, guarded = folder.columns(
        "softening", "radius over wanted", "overlap over diameter by the closed form",
        "overlap over diameter", "contact time over that wanted", "safeguarded")
    free = guarded == 0
    line(axes[1], 1 / size, 100 * np.minimum(closed, 0.15), "closed form, limit of the safeguard")
    silt(axes[1], 1 / size, 100 * found, COLOURS[0], "silt, largest overlap")
    name_axes(axes[1], "wanted radius over radius s [-]", "overlap over diameter [%]")
    axes[1].set(xscale="log", yscale="log")
    axes[1].set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    axes[1].set_yticks([1, 2, 5, 10, 15], ["1", "2", "5", "10", "15"])
    axes[1].minorticks_off()
    other = axes[1].twinx()
    other.plot(1 / size[free], times[free], "s", color=COLOURS[5], ms=4.5)
    other.set_ylim(0.8, 1.2)
    other.set_ylabel("contact time over that of s = 1 [-]", fontsize=10, color=COLOURS[5])
    other.tick_params(labelsize=9, colors=COLOURS[5])
    other.spines["top"].set_visible(False)
    axes[1].plot([], [], "s", color=COLOURS[5], ms=4.5, label="silt, contact time")
    legend(axes[1], loc="lower right")
    folder.save(figure, "sizes")


# ------------------------------------------------------------------------- oblique impacts


SOURCES = [(" by MBF", "Maw, Barber, Fawcett (e = 1)", "--", COLOURS[2]),
           (" rigid", "rigid body", ":", "black"),
           (" by the law", "the law, integrated apart", "-", "black")]


def draw_angles(folder, picture, title, tables, series):
    figure, axes = sheet(3, title, 4.1, 3.9)
    quantities = [("tangential restitution", "restitution", "v$_x$'/v$_x$ [-]"),
                  ("angular velocity", "spin", "angular velocity after [rad/s]"),
                  (series["angle"], "angle", series["words"] + " [deg]")]
    for axis, (column, kind, words) in zip(axes, quantities):
        first = tables[0][0]
        for suffix, label, style, colour in SOURCES:
            angle, y = folder.columns(first, "angle of incidence", column + suffix)
            line(axis, angle, y, label, style, colour)
        for mark, name, label in series["published"]:
            points(axis, f"{series['figure']} {kind}", name, label, mark[0], mark[1])
        for (table, label), colour, marker in zip(tables, COLOURS, "o^"):
            angle, y = folder.columns(table, "angle of incidence", column)
            silt(axis, angle, y, colour, label, marker, 2 if len(angle) > 20 else 1)
        name_axes(axis, "angle of incidence [deg]", words)
        axis.set_xlim(0, 90)
    legend(axes[0], loc="lower right")
    folder.save(figure, picture)


def draw_test_5(folder):
    figure, axes = sheet(2, "Test 5: oblique on a rigid plane, normal speed 5 m/s, e = 1, µ = 0.3",
                         4.9, 4.2)
    for axis, column, kind, words in zip(
            axes, ["recoil", "reduced spin"], ["recoil", "spin"],
            ["recoil v$_s$'/(µ v$_n$') [-]", "R ω'/(µ v$_n$) [-]"]):
        for suffix, label, style, colour in SOURCES:
            x, y = folder.columns("chung_ooi_5_steel", "incidence", column + suffix)
            line(axis, x, y, label, style, colour)
        points(axis, f"chung_ooi_5 {kind}", FEM, FEM, "D", COLOURS[2])
        points(axis, f"chung_ooi_5 {kind}", DEM + " steel", "Chung and Ooi, DEM, steel", "s")
        for (name, label), colour, marker in zip(
                [("steel", "silt, steel"), ("polyethylene", "silt, polyethylene")], COLOURS, "o^"):
            x, y = folder.columns("chung_ooi_5_" + name, "incidence", column)
            silt(axis, x, y, colour, label, marker, 3 if len(x) > 20 else 1)
        name_axes(axis, "incidence v$_s$/(µ v$_n$) [-]", words)
        axis.set_xlim(0, 13.5)
    legend(axes[1], loc="lower right")
    folder.save(figure, "chung_ooi_5")


def draw_spinning(folder, picture, title, cases, reference):
    figure, axes = sheet(2, title, 4.9, 4.0)
    for axis, (x_name, x_words, y_name, kind, y_words) in zip(axes, [
            ("incidence", "incidence v$_s$/v$_n$ [-]", "recoil", "recoil",
             "recoil v$_s$'/v$_n$' [-]"),
            ("3.5 mu (1 + e) v_n over v_s", "3.5 µ (1 + e) v$_n$/v$_s$ [-]", "beta", "beta",
             "β = -v$_s$'/v$_s$ [-]")]):
        for suffix, label, style, colour in SOURCES[1:]:
            x, y = folder.columns(cases[0][0], x_name, y_name + suffix)
            line(axis, x, y, label, style, colour)
        if kind in reference["kinds"]:
            for name, label, mark, colour in reference["series"]:
                points(axis, f"{reference['figure']} {kind}", name, label, mark, colour)
        for (table, label), colour, marker in zip(cases, COLOURS, "o^vD"):
            x, y = folder.columns(table, x_name, y_name)
            silt(axis, x, y, colour, label, marker, 2 if len(x) > 20 else 1)
        name_axes(axis, x_words, y_words)
    axes[0].set(xlim=(0, 4), ylim=(-0.7, 4.3))
    axes[1].set(xscale="log", xlim=(0.15, 30), ylim=(-1, 0.35))
    legend(axes[0], loc="upper left")
    folder.save(figure, picture)


def draw_test_7(folder):
    figure, axes = sheet(2, "Test 7: equal balls, opposite spins", 4.3, 3.5)
    for (name, words), colour, marker in zip(
            [("aluminium_alloy", "aluminium alloy"), ("copper", "copper")], COLOURS, "os"):
        before, v, after = folder.columns("chung_ooi_7_" + name, "angular velocity before",
                                          "tangential velocity after", "angular velocity after")
        open_too = {} if marker == "o" else {"mfc": "none", "ms": 8}
        axes[0].plot(before, after, marker, color=colour, **{"ms": 4.5, **open_too},
                     label=f"silt, {words}", zorder=4)
        axes[1].plot(before, 1e3 * v, marker, color=colour, **{"ms": 4.5, **open_too},
                     label=f"silt, {words}", zorder=4)
    line(axes[0], before, before, "nothing changes")
    line(axes[1], before, 0 * before, "nothing changes")
    name_axes(axes[0], "angular velocity before [rad/s]", "angular velocity after [rad/s]")
    name_axes(axes[1], "angular velocity before [rad/s]", "tangential velocity after [mm/s]")
    axes[1].set_ylim(-1, 1)
    legend(axes[0])
    folder.save(figure, "chung_ooi_7")


# ------------------------------------------------------------------------------- the others


def draw_planes(folder):
    figure, axes = sheet(2, "A sphere on a plane: µ = 0.2, rolling resistance µ$_r$ = 0.1", 4.9, 3.8)
    tangent, free, rough, free_exact, rough_exact = folder.columns(
        "slopes", "tangent of the slope", "acceleration over g cos", "with rolling resistance",
        "rigid body", "rigid body with rolling resistance")
    fine = np.linspace(0, tangent.max(), 2000)
    for rolling, style, label in [(0, "-", "rigid body"), (0.1, "--", "rigid body, µ$_r$")]:
        rolls = 5 / 7 * (fine - rolling)
        exact = np.where(fine <= rolling, 0, np.where(fine - rolls <= 0.2, rolls, fine - 0.2))
        line(axes[0], fine, exact, label, style)
    silt(axes[0], tangent, free, COLOURS[0], "silt")
    silt(axes[0], tangent, rough, COLOURS[5], "silt, rolling model C", "s")
    for place, words in [(0.1, "3.5 µ - 2.5 µ$_r$"), (0.7, "3.5 µ")]:
        x = 0.45 if place == 0.1 else 0.7
        axes[0].axvline(x, color="0.7", lw=0.8, zorder=1)
        axes[0].text(x + 0.01, 0.93, words, fontsize=8, color="0.35", va="top",
                     transform=axes[0].get_xaxis_transform())
    name_axes(axes[0], "slope tan θ [-]", "acceleration over g cos θ [-]")
    legend(axes[0], loc="lower right")
    t, v, w, v_exact, w_exact = folder.columns("slip_to_roll", "time", "speed", "R w", "speed rigid",
                                               "R w rigid")
    line(axes[1], 1e3 * t, 1e3 * v_exact, "rigid body")
    line(axes[1], 1e3 * t, 1e3 * w_exact, None)
    silt(axes[1], 1e3 * t, 1e3 * v, COLOURS[0], "silt, speed v")
    silt(axes[1], 1e3 * t, 1e3 * w, COLOURS[5], "silt, R ω", "s")
    name_axes(axes[1], "time [ms]", "speed [mm/s]")
    legend(axes[1], loc="center right")
    folder.save(figure, "on_a_plane")


def draw_jkr(folder):
    figure, axes = sheet(1, "JKR: a plane comes to a sphere and leaves", 5.4, 4.0)
    axis = axes[0]
    d, f, exact = folder.columns("jkr", "overlap over that at rest", "force over pull-off", "JKR")
    back = np.argmax(d)
    line(axis, d, np.where(exact == 0, np.nan, exact), "JKR")
    silt(axis, d[:back], f[:back], COLOURS[0], "silt, towards each other", "o", 2)
    silt(axis, d[back:], f[back:], COLOURS[5], "silt, away", "^", 2)
    for value, words in [(-1, "-1"), (-5 / 9, "-5/9"), (-8 / 9, "-8/9")]:
        axis.axhline(value, color="0.6", lw=0.8, ls=":", zorder=1)
        axis.text(2.3, value, words, fontsize=8, color="0.35", va="bottom")
    axis.set(xlim=(-1.7, 2.6), ylim=(-1.25, 1.6))
    name_axes(axis, "overlap over that at rest [-]", "force over the pull-off force [-]")
    legend(axis, loc="upper left")
    folder.save(figure, "jkr")


def draw_haff(folder):
    figure, axes = sheet(2, "A cooling gas: e = 0.9, 5 % solid", 4.7, 3.8)
    x, T, exact, band = folder.columns("haff", "time over tau", "temperature over T0", "Haff",
                                       "tolerance")
    line(axes[0], 1 + x, exact, "Haff: (1 + t/τ)$^{-2}$")
    silt(axes[0], 1 + x, T, COLOURS[0], "silt", "o", max(1, len(x) // 30))
    axes[0].set(xscale="log", yscale="log")
    ticks = [1, 2, 3, 4, 6, 10]
    axes[0].set_xticks(ticks, [str(n) for n in ticks])
    axes[0].minorticks_off()
    name_axes(axes[0], "1 + t/τ [-]", "temperature T/T$_0$ [-]")
    legend(axes[0])
    line(axes[1], x, 0 * x, "Haff")
    silt(axes[1], x, 100 * (T / exact - 1), COLOURS[0], "silt", "o", max(1, len(x) // 60))
    for sign in (1, -1):
        line(axes[1], x, 100 * sign * band, "tolerance" if sign > 0 else None, ":")
    name_axes(axes[1], "t/τ [-]", "T over Haff's law less 1 [%]")
    legend(axes[1])
    folder.save(figure, "haff")


def draw_all(folder):
    draw_elastic(folder, 1, [("glass", "glass"), ("limestone", "limestone")],
                 "Test 1: two equal spheres, 10 m/s each", "glass")
    draw_elastic(folder, 2, [("aluminium_alloy", "aluminium alloy"),
                             ("magnesium_alloy", "magnesium alloy")],
                 "Test 2: a sphere on a rigid plane, 0.2 m/s", "aluminium alloy")
    draw_restitutions(folder)
    draw_angles(folder, "chung_ooi_4", "Test 4: 5 mm spheres on a rigid plane, 3.9 m/s",
                [("chung_ooi_4_aluminium_oxide", "silt, aluminium oxide"),
                 ("chung_ooi_4_aluminium_alloy", "silt, aluminium alloy")],
                {"figure": "chung_ooi_4", "angle": "rebound angle of the surface",
                 "words": "rebound angle of the surface",
                 "published": [(("s", "0.35"), DEM, "Chung and Ooi, DEM"),
                               (("D", COLOURS[3]), KHARAZ, "Kharaz et al., measured")]})
    draw_test_5(folder)
    alloy, nylon = ("aluminium_alloy", "aluminium alloy"), ("nylon", "nylon")
    draw_spinning(folder, "chung_ooi_6", "Test 6: a spinning ball on a rigid plane, 0.2 m/s, e = 0.5",
                  [("chung_ooi_6_" + n, "silt, " + w) for n, w in (alloy, nylon)],
                  {"figure": "chung_ooi_6", "kinds": ["recoil", "beta"],
                   "series": [(DEM + " aluminium alloy", "Chung and Ooi, DEM, alloy", "s", "0.35")]})
    draw_test_7(folder)
    draw_spinning(folder, "chung_ooi_8", "Test 8: a spinning ball on one five times as large, e = 0.5",
                  [(f"chung_ooi_8_case_{c}_{n}", f"silt, {w}, case {c.upper()}")
                   for n, w in (alloy, nylon) for c in "ab"],
                  {"figure": "chung_ooi_8", "kinds": ["recoil"],
                   "series": [(DEM + " aluminium alloy case A", "Chung and Ooi, DEM, alloy, A", "s",
                               "0.35"),
                              (DEM + " aluminium alloy case B", "Chung and Ooi, DEM, alloy, B", "D",
                               COLOURS[3])]})
    draw_angles(folder, "alumina_on_glass", "5 mm alumina spheres on glass, 3.9 m/s",
                [("alumina_on_glass", "silt")],
                {"figure": "alumina_on_glass", "angle": "rebound angle of the centre",
                 "words": "rebound angle of the centre",
                 "published": [(("D", COLOURS[3]), KHARAZ, "Kharaz et al., measured")]})
    draw_steps(folder)
    draw_sizes(folder)
    draw_planes(folder)
    draw_jkr(folder)
    draw_haff(folder)


def main():
    if len(sys.argv) != 2:
        sys.stderr.write("pictures.py: give the folder with the tables, e.g. out/verification\n")
        return 2
    try:
        draw_all(Folder(sys.argv[1]))
    except Error as refusal:
        sys.stderr.write(f"pictures.py: {refusal}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
