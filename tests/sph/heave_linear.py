#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Heave of a box that floats in a closed tank, by linear potential theory: the curve that
tests/sph/heave.cpp compares with.

Bilinear finite elements for Laplace's equation in one half of the tank (the other is its mirror
image). Unknowns: the surface's height eta at its nodes, the box's heave zeta. Both are measured
from rest; the liquid's volume is a constraint.

    K phi = S eta' + c zeta'       (the fluxes through surface and bottom of the box)
    T = 1/2 rho phi.K phi + 1/2 m zeta'^2,  V = 1/2 rho g (eta.S eta + b zeta^2)

Prints t [s] and zeta [mm] for each grid given as cells per 25 mm: heave_linear.py 2 4 8
"""
import sys

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

RHO, G = 1000.0, 9.81
START = 0.02  # zeta at t = 0, at rest, the surface flat
LENGTH, DEPTH = 1.0, 0.4 + 0.25 * START  # of the tank, of the liquid at rest
WIDTH, DRAUGHT = 0.2, 0.1  # of the box, of half the liquid's density


def heave(per_25mm, times):
    xs = np.linspace(0, LENGTH / 2, 20 * per_25mm + 1)
    below = np.linspace(-DEPTH, -DRAUGHT, 12 * per_25mm + 1)
    zs = np.concatenate([below, np.linspace(-DRAUGHT, 0, 4 * per_25mm + 1)[1:]])
    edge, top = LENGTH / 2 - WIDTH / 2, len(below) - 1  # box: x > edge, above node `top`
    number = -np.ones((len(xs), len(zs)), int)
    rows, columns, values, count = [], [], [], 0
    for i in range(len(xs) - 1):
        for j in range(len(zs) - 1):
            if xs[i] > edge - 1e-9 and j >= top:
                continue
            nodes = []
            for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                if number[a, b] < 0:
                    number[a, b], count = count, count + 1
                nodes.append(number[a, b])
            r = (zs[j + 1] - zs[j]) / (xs[i + 1] - xs[i])
            kx = np.array([[2, -2, -1, 1], [-2, 2, 1, -1], [-1, 1, 2, -2], [1, -1, -2, 2]]) / 6
            kz = np.array([[2, 1, -1, -2], [1, 2, -2, -1], [-1, -2, 2, 1], [-2, -1, 1, 2]]) / 6
            k = r * kx + kz / r
            for a in range(4):
                for b in range(4):
                    rows.append(nodes[a]), columns.append(nodes[b]), values.append(k[a, b])
    stiffness = coo_matrix((values, (rows, columns)), (count, count)).tocsc()
    surface = [number[i, -1] for i in range(len(xs)) if number[i, -1] >= 0]
    dx, n = xs[1] - xs[0], len(surface)
    S = np.zeros((n, n))
    for k in range(n - 1):
        S[k : k + 2, k : k + 2] += dx / 6 * np.array([[2, 1], [1, 2]])
    flux = np.zeros((count, n + 1))
    flux[surface, :n] = S
    for i in range(len(xs) - 1):
        if xs[i] > edge - 1e-9:
            flux[number[i, top], n] += dx / 2
            flux[number[i + 1, top], n] += dx / 2
    # Volume: motions q with sum S eta + b/2 zeta = 0; phi is then known but for a constant.
    basis = null_space(flux.sum(axis=0)[None, :])
    right = flux @ basis
    phi = np.zeros_like(right)
    phi[1:] = splu(stiffness[1:, 1:]).solve(right[1:])
    half_mass = np.zeros((n + 1, n + 1))
    half_mass[n, n] = RHO * DRAUGHT * WIDTH / 2
    mass = RHO * right.T @ phi + basis.T @ half_mass @ basis
    height = np.zeros((n + 1, n + 1))
    height[:n, :n], height[n, n] = S, WIDTH / 2
    spring = RHO * G * basis.T @ height @ basis
    squares, modes = eigh(spring, (mass + mass.T) / 2)
    start = np.full(n + 1, -WIDTH * START / (LENGTH - WIDTH))
    start[n] = START
    share = modes.T @ ((mass + mass.T) / 2) @ (basis.T @ start)
    of_box = (basis @ modes)[n]
    largest = np.argsort(-np.abs(of_box * share))[:4]
    print("grid", per_25mm, "periods [s]", 2 * np.pi / np.sqrt(squares[largest]), "amplitudes [mm]",
          1000 * (of_box * share)[largest], file=sys.stderr)
    return np.array([np.sum(of_box * share * np.cos(np.sqrt(squares) * t)) for t in times])


times = np.arange(0, 2.0001, 0.05)
curves = [heave(int(n), times) for n in (sys.argv[1:] or ["4"])]
for k, t in enumerate(times):
    print(f"{t:.2f}", *(f"{1000 * c[k]:.3f}" for c in curves))
