#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""ratios.py REVISION N FOLDER: time of a step over that of REVISION, scene by scene, from N pairs of
runs that compare.sh has left in FOLDER."""
import statistics
import sys

revision, count, folder = sys.argv[1], int(sys.argv[2]), sys.argv[3]


def times(name, k):
    with open(f"{folder}/times_{name}.{k}") as f:
        return {line[:28].strip(): float(line[28:]) for line in f}


pairs = [(times(revision, k), times("now", k)) for k in range(count)]
print(f"{'scene':28}  us a step   over that of {revision} (quartiles)")
medians = []
for scene in pairs[0][0]:
    ratios = sorted(now[scene] / then[scene] for then, now in pairs)
    low, middle, high = statistics.quantiles(ratios, n=4) if count > 1 else ratios * 3
    medians.append(middle)
    step = 1e6 * statistics.median(now[scene] for _, now in pairs)
    print(f"{scene:28} {step:10.4g}   {middle:.3f} ({low:.3f} to {high:.3f})")
print(f"{'geometric mean':28} {'':10}   {statistics.geometric_mean(medians):.3f}")
