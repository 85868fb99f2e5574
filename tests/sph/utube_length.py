#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""Effective length of the water in the U-tube of edges.cpp, by its potential flow.

The stream function, 0 on the outer and 1 on the inner walls, by finite differences with n cells
across a leg; the kinetic energy of a unit flux is that of a straight column of this length.
Prints length [m] and period [s] for each n: 0.8113 m and 1.2777 s in the limit.
"""
import math

import numpy as np
import scipy.sparse
import scipy.sparse.linalg


def length(n):
    """In widths of a leg: legs from 0 to 4, the block from 1 to 2 across and from 1 up."""
    nx, nz = 3 * n + 1, 4 * n + 1
    across, up = np.meshgrid(np.arange(nx), np.arange(nz), indexing="ij")
    block = (across >= n) & (across <= 2 * n) & (up >= n)
    wall = (across == 0) | (across == nx - 1) | (up == 0)
    psi = np.where(block, 1.0, 0.0)
    psi[:, -1] = np.minimum(np.minimum(across[:, -1], nx - 1 - across[:, -1]) / n, 1)
    free = ~(block | wall | (up == nz - 1))
    number = np.full((nx, nz), -1)
    number[free] = np.arange(free.sum())
    rows, columns, right = [], [], np.zeros(free.sum())
    i, k = np.nonzero(free)
    for di, dk in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        other = number[i + di, k + dk]
        inside = other >= 0
        rows.append(number[i, k][inside])
        columns.append(other[inside])
        np.add.at(right, number[i, k][~inside], psi[i + di, k + dk][~inside])
    rows, columns = np.concatenate(rows), np.concatenate(columns)
    matrix = scipy.sparse.csr_matrix((-np.ones(rows.size), (rows, columns)))
    matrix += 4 * scipy.sparse.identity(right.size)
    psi[free] = scipy.sparse.linalg.spsolve(matrix.tocsr(), right)
    along_x, along_z = np.diff(psi, axis=0) ** 2, np.diff(psi, axis=1) ** 2
    along_x[:, [0, -1]] /= 2
    along_z[[0, -1], :] /= 2
    return along_x.sum() + along_z.sum()


for n in (20, 40, 80):
    meters = 0.1 * length(n)
    print(n, round(meters, 5), round(2 * math.pi * math.sqrt(meters / (2 * 9.81)), 5))
