#!/usr/bin/env python3
# silt - BSD-3-Clause, see LICENSE
"""The tests of the Python package: python_check.py PROGRAM, which writes the files that they read
(tests/python/scenes.cpp).

Exit status 77: this Python has no numpy or no matplotlib; only the sentence that says so has been
looked at.
"""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.join(HERE, "..", "python")


def bare_sentences():
    """Catches a raw ModuleNotFoundError: without site packages there is no numpy."""
    wrong = []
    for arguments, lacks in ((["draw", "x.vtp", "-o", "x.png"], "has no numpy and no matplotlib; "),
                             (["info", "x.vtp"], "has no numpy; ")):
        done = subprocess.run([sys.executable, "-S", "-E", os.path.join(PACKAGE, "silt"), *arguments],
                              capture_output=True, text=True)
        if done.returncode != 2 or lacks not in done.stderr or done.stderr.count("\n") != 1:
            wrong.append(f"without numpy: status {done.returncode}, {done.stderr!r}")
    return wrong


def main():
    wrong = bare_sentences()
    for sentence in wrong:
        print("FAIL:", sentence)
    sys.path[:0] = [PACKAGE, os.path.join(HERE, "python")]
    from silt import needs

    if needs.missing("numpy", "matplotlib"):
        return 1 if wrong else 77
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], os.path.join(folder, "out")], check=True)
        import scenes

        scenes.FOLDER = os.path.join(folder, "out")
        tests = unittest.defaultTestLoader.discover(os.path.join(HERE, "python"))
        result = unittest.TextTestRunner(verbosity=1).run(tests)
    return 0 if result.wasSuccessful() and not wrong else 1


if __name__ == "__main__":
    sys.exit(main())
