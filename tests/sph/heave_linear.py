#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Heave of a body that floats in a closed tank, by linear potential theory: the curves that
tests/sph/heave.cpp compares with.

Linear finite elements for Laplace's equation in one half of the tank (the other is its mirror
image). Unknowns: the surface's height eta at its nodes, the body's heave zeta. Both are measured
from rest; the liquid's volume is a constraint.

    K phi = S eta' + c zeta'       (the fluxes through the surface and the body's wetted side)
    T = 1/2 rho phi.K phi + 1/2 m zeta'^2,  V = 1/2 rho g (eta.S eta + b zeta^2)

Prints t [s] and zeta [mm] for each mesh, given as cells per 100 mm: heave_linear.py disc 8 16 24
"""
import sys

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay

RHO, G = 1000.0, 9.81
START = 0.02  # zeta at t = 0, at rest, the surface flat
LENGTH, DEPTH = 1.0, 0.4 + 0.25 * START  # of the tank, of the liquid at rest
RADIUS = 0.1  # of the disc; half the width, and the draught, of the box: half the liquid's density


def mesh(body, cells):
    """Nodes, triangles, and the nodes of the wetted side in order. The body's middle is x = L/2."""
    size, middle = 0.1 / cells, LENGTH / 2
    points, side, outer = [], [], 0.0
    if body == "disc":
        for r in np.arange(RADIUS, 2.5 * RADIUS, size):
            around = int(round(np.pi / 2 * r / size))
            for angle in np.linspace(np.pi, 1.5 * np.pi, around + 1):
                points.append((middle + r * np.cos(angle), r * np.sin(angle)))
            side, outer = side or list(range(len(points))), r
    for x in np.linspace(0, middle, int(round(middle / size)) + 1):
        for z in np.linspace(-DEPTH, 0, int(round(DEPTH / size)) + 1):
            z = -RADIUS if body == "box" and abs(z + RADIUS) < 0.49 * size else z
            in_box = x > middle - RADIUS + 1e-9 and z > -RADIUS + 1e-9
            if not in_box if body == "box" else np.hypot(x - middle, z) > outer + 0.5 * size:
                if body == "box" and x > middle - RADIUS - 1e-9 and z == -RADIUS:
                    side.append(len(points))
                points.append((x, z))
    points = np.array(points)
    points[np.abs(points[:, 1]) < 1e-9, 1] = 0
    triangles = Delaunay(points).simplices
    x, z = points[triangles].mean(axis=1).T
    if body == "box":
        out = (x < middle - RADIUS) | (z < -RADIUS)
    else:
        out = np.hypot(x - middle, z) > RADIUS * np.cos(np.pi / 4 / (len(side) - 1)) - 1e-9
    return points, triangles[out], side


def heave(body, cells, times):
    points, triangles, side = mesh(body, cells)
    a = points[triangles]
    along = np.stack([a[:, 1] - a[:, 2], a[:, 2] - a[:, 0], a[:, 0] - a[:, 1]], axis=1)
    area = 0.5 * np.abs(along[:, 0, 0] * along[:, 1, 1] - along[:, 0, 1] * along[:, 1, 0])
    good = area > 1e-12
    triangles, along, area = triangles[good], along[good], area[good]
    values = np.einsum("tik,tjk->tij", along, along) / (4 * area)[:, None, None]
    rows, columns = np.repeat(triangles, 3, axis=1).ravel(), np.tile(triangles, (1, 3)).ravel()
    count = len(points)
    stiffness = coo_matrix((values.ravel(), (rows, columns)), (count, count)).tocsc()
    surface = np.where(points[:, 1] == 0)[0]
    surface = surface[np.argsort(points[surface, 0])]
    n = len(surface)
    S = np.zeros((n, n))
    for k in range(n - 1):
        dx = points[surface[k + 1], 0] - points[surface[k], 0]
        S[k : k + 2, k : k + 2] += dx / 6 * np.array([[2, 1], [1, 2]])
    flux = np.zeros((count, n + 1))
    flux[surface, :n] = S
    for p, q in zip(side[:-1], side[1:]):
        flux[[p, q], n] += (points[q, 0] - points[p, 0]) / 2
    # Volume: motions q with sum S eta + b/2 zeta = 0; phi is then known but for a constant.
    basis = null_space(flux.sum(axis=0)[None, :])
    right = flux @ basis
    phi = np.zeros_like(right)
    phi[1:] = splu(stiffness[1:, 1:]).solve(right[1:])
    half_mass = np.zeros((n + 1, n + 1))
    displaced = 2 * RADIUS**2 if body == "box" else np.pi / 2 * RADIUS**2
    half_mass[n, n] = RHO * displaced / 2
    mass = RHO * right.T @ phi + basis.T @ half_mass @ basis
    height = np.zeros((n + 1, n + 1))
    height[:n, :n], height[n, n] = S, RADIUS
    spring = RHO * G * basis.T @ height @ basis
    squares, modes = eigh(spring, (mass + mass.T) / 2)
    start = np.full(n + 1, -2 * RADIUS * START / (LENGTH - 2 * RADIUS))
    start[n] = START
    share = modes.T @ ((mass + mass.T) / 2) @ (basis.T @ start)
    of_body = (basis @ modes)[n]
    return np.array([np.sum(of_body * share * np.cos(np.sqrt(squares) * t)) for t in times])


body = sys.argv[1] if len(sys.argv) > 1 else "disc"
if body not in ("disc", "box"):
    sys.exit(f"heave_linear.py: {body} is no body; give disc or box, and cells per 100 mm")
times = np.arange(0, 1.0001, 0.05)
curves = [heave(body, int(n), times) for n in (sys.argv[2:] or ["16"])]
for k, t in enumerate(times):
    print(f"{t:.2f}", *(f"{1000 * c[k]:.2f}" for c in curves))
