# silt - BSD-3-Clause, see LICENSE
#
# Results in Python. Reads the beads that ./run example beads has written, and plots how they come to
# rest and how densely they lie over the height; prints the solid fraction of the bed.
#
# after: beads
# picture: reading.png

import sys

import matplotlib
import numpy as np

import silt

matplotlib.use("Agg")
import matplotlib.pyplot as plt

bed = silt.open("beads/particles.pvd")
speed = np.array([frame["|velocity|"].mean() for frame in bed])  # [m/s] of all beads, in each frame
highest = bed[0].ids[bed[0]["position.z"].argmax()]
times, falling = bed.track(highest, "|velocity|")  # of one bead, through all frames

# Solid fraction in layers: of a sphere, the volume below each height is known in closed form.
last = bed[-1]
z, r = last["position.z"], last["radius"]
heights = np.arange(0, z.max() + 2e-3, 2.5e-4)  # [m]
below = np.clip(heights[:, None] - (z - r), 0, 2 * r)  # [m] how far each sphere reaches below each
volume = (np.pi * below**2 * (3 * r - below) / 3).sum(axis=1)  # [m3]
fraction = np.diff(volume) / (0.03 * 0.02 * np.diff(heights))
middle = 0.5 * (heights[1:] + heights[:-1])
bulk = fraction[(middle > 4e-3) & (middle < z.max() - 4e-3)].mean()

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
left.plot(bed.times, speed, lw=1.8, label="mean of all")
left.plot(times, falling, lw=1.2, label="highest bead")
left.set(xlabel="time [s]", ylabel="speed [m/s]", ylim=0)
left.legend(frameon=False)
right.plot(fraction, 1e3 * middle, lw=1.8)
right.axvline(bulk, color="0.6", ls="--", lw=1)
right.set(xlabel="solid fraction [-]", ylabel="height [mm]", xlim=0, ylim=0)
for axes in (left, right):
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="0.9")
figure.savefig("reading.png", dpi=130)

print(f"{len(bed)} frames of {len(last)} beads; at rest to {speed[-1]:.1e} m/s")
print(f"solid fraction {bulk:.3f} between 4 mm from the floor and 4 mm from the top")
# Catches places or radii that are read wrongly: beads at random pack to 0.55 to 0.65.
sys.exit(0 if 0.52 < bulk < 0.68 and speed[-1] < 1e-3 else 1)
