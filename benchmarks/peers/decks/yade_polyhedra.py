# silt - BSD-3-Clause, see LICENSE
"""yade -n -x -j1 yade_polyhedra.py FILE WARMUP STEPS SKIN BODIES END: times 216 random polyhedra that
fall on a plane, from FILE on, which is made, 3 000 steps from the start, where it is not there. SKIN [m]
of its list. BODIES, END: where they are then, and after WARMUP and STEPS, a line each: place, quaternion
(w first), velocity, spin, corners."""
import os
import sys
import time

from yade import *
from yade import log, polyhedra_utils


def scene():
    material = PolyhedraMat()
    material.density, material.young, material.poisson, material.frictionAngle = 2600, 1e8, 0.02, 0.6
    O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))
    for i in range(6):
        for j in range(6):
            for k in range(6):
                one = polyhedra_utils.polyhedra(material, size=(0.01, 0.01, 0.01),
                                                seed=i * 36 + j * 6 + k)
                one.state.pos = (i * 0.012, j * 0.012, 0.012 + k * 0.014)
                O.bodies.append(one)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()]),
        InteractionLoop([Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom(),
                         Ig2_Facet_Polyhedra_PolyhedraGeom()],
                        [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
                        [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
        NewtonIntegrator(damping=0.3, gravity=(0, 0, -9.81)),
    ]
    O.dt = 2e-5


log.setLevel("Default", log.FATAL)  # it would warn hundreds of times a step of a case that is none
file, warmup, steps, skin, start_file, end_file = sys.argv[1:7]
if not os.path.exists(file):
    scene()
    O.run(3000, True)
    O.save(file)
O.load(file)
next(e for e in O.engines if isinstance(e, InsertionSortCollider)).verletDist = float(skin)


def write(path):
    with open(path, "w") as f:
        for body in O.bodies:
            if not isinstance(body.shape, Polyhedra):
                continue
            s, q = body.state, body.state.ori
            corners = [x for corner in body.shape.v for x in corner]
            f.write(" ".join(f"{x:.17g}" for x in [*s.pos, q[3], q[0], q[1], q[2], *s.vel, *s.angVel,
                                                   *corners]) + "\n")


write(start_file)
O.run(int(warmup), True)
start = time.time()
O.run(int(steps), True)
seconds = time.time() - start
write(end_file)
pairs = sum(1 for c in O.interactions if c.isReal and min(c.id1, c.id2) > 0)  # 0: the plane
print("seconds", seconds, "own_contacts", 2 * pairs / 216)
