# silt - BSD-3-Clause, see LICENSE
"""yade -n -x -j1 yade_bodies.py BODIES FORM WIDTH WARMUP STEPS SKIN END: the bed of bench_bodies in
Yade. SKIN: of its list, over the radius of a ball."""
import math
import sys
import time

from yade import *

bodies, form, width, warmup, steps, skin, end = sys.argv[1:8]
width = float(width)
material = FrictMat(young=1e6, poisson=0.3, density=2500, frictionAngle=math.atan(0.4))
O.materials.append(material)
for axis, place, sense in ((0, 0, 1), (0, width, -1), (1, 0, 1), (1, width, -1), (2, 0, 1)):
    O.bodies.append(utils.wall(place, axis=axis, sense=sense, material=material))
with open(form) as f:
    balls = [[float(word) for word in line.split()] for line in f]
clumps = []
with open(bodies) as f:
    for line in f:
        x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz = map(float, line.split())
        turn = Quaternion(qw, qx, qy, qz)
        spheres = [utils.sphere(Vector3(x, y, z) + turn * Vector3(*ball[:3]), ball[3],
                                material=material) for ball in balls]
        clump, members = O.bodies.appendClumped(spheres, discretization=20)
        clumps.append((O.bodies[clump].state, members))
        clumps[-1][0].vel, clumps[-1][0].angVel = Vector3(vx, vy, vz), Vector3(wx, wy, wz)
# The dashpot of a restitution of 0.5 as LIGGGHTS and silt have it. Yade takes the masses of the
# balls for it, not those of the clumps: that much more damping makes up for it.
ln = math.log(0.5)
beta = math.sqrt(5 / 6) * -ln / math.hypot(ln, math.pi)
beta *= math.sqrt(clumps[0][0].mass / O.bodies[clumps[0][1][0]].state.mass)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=-float(skin)),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(betan=beta)],
                    [Law2_ScGeom_MindlinPhys_Mindlin()]),
    NewtonIntegrator(damping=0, gravity=(0, 0, -9.81)),
]
O.dt = 2e-5
O.run(int(warmup), True)
start = time.time()
O.run(int(steps), True)
seconds = time.time() - start
energy = sum(0.5 * state.mass * state.vel.squaredNorm() for state, _ in clumps)
print("seconds", seconds, "kinetic_energy", energy)
with open(end, "w") as f:
    for _, members in clumps:
        for k, ball in zip(members, balls):
            f.write("%.9g %.9g %.9g %.9g\n" % (*O.bodies[k].state.pos, ball[3]))
