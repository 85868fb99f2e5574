# silt - BSD-3-Clause, see LICENSE
"""yade -n -x -j1 yade_bonds.py SIDE WARMUP STEPS: the cube of bench_bonds in Yade, of cohesive contacts
that bear moments and never break."""
import sys
import time

from yade import *

side, warmup, steps = (int(word) for word in sys.argv[1:4])
radius, step = 1e-3, 1e-6
middle = radius * (side - 1)
material = CohFrictMat(young=1e7, poisson=0.4, density=2000, frictionAngle=0.46, normalCohesion=1e30,
                       shearCohesion=1e30, momentRotationLaw=True, alphaKr=1.0, alphaKtw=1.0,
                       etaRoll=-1, etaTwist=-1, isCohesive=True)
O.materials.append(material)
for x in range(side):
    for y in range(side):
        for z in range(side):
            # Nearer by 1e-9 of the radius, so that rounding misses no contact.
            place = [2 * radius * (1 - 1e-9) * c for c in (x, y, z)]
            O.bodies.append(utils.sphere(place, radius, material=material))
            O.bodies[-1].state.vel = ((2 * radius * x - middle) * 0.1, 0, 0)
glue = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=False)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0.1 * radius),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom6D()], [glue],
                    [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True)]),
    NewtonIntegrator(damping=0, gravity=(0, 0, 0)),
]
O.dt = step
O.run(warmup, True)
begin = time.time()
O.run(steps, True)
seconds = time.time() - begin
bonds = sum(1 for i in O.interactions if i.isReal and not i.phys.cohesionBroken)
# Velocities are those of half a step ago: the mean with those of half a step later.
before = [Vector3(b.state.vel) for b in O.bodies]
O.run(1, True)
kinetic = sum(0.5 * b.state.mass * (0.5 * (v + b.state.vel)).squaredNorm()
              for v, b in zip(before, O.bodies))
print("seconds %g bonds %d kinetic %.12g" % (seconds, bonds, kinetic))
