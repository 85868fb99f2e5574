# silt - BSD-3-Clause, see LICENSE
"""What the tests of the Python package share: the folder that scenes.cpp wrote, and ways to look."""

import contextlib
import functools
import io
import os
import subprocess
import sys

PACKAGE = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
FOLDER = os.environ.get("SILT_SCENES", "")  # or set by python_check.py


def path(*parts):
    return os.path.join(FOLDER, *parts)


def has(name):
    """Whether the program wrote this: some scenes are of the long tests."""
    return os.path.isdir(path(name))


def needs(name):
    """Decorator of tests that read a scene of the long tests."""
    def wrap(test):
        @functools.wraps(test)
        def wrapped(self):
            if not has(name):
                self.skipTest(f"{name}/ is of the long tests")
            test(self)
        return wrapped
    return wrap


def run(*arguments):
    """`silt ARGUMENTS` without a start of Python, which takes longest."""
    from silt import command

    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = command.run([str(a) for a in arguments])
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), err.getvalue())


def run_apart(*arguments):
    """`silt ARGUMENTS` as a user runs it."""
    return subprocess.run([sys.executable, os.path.join(PACKAGE, "silt"), *map(str, arguments)],
                          capture_output=True, text=True)


class Refuses:
    """Mixin: status 2, and one sentence on stderr that has these words."""

    def refused(self, words, *arguments):
        done = run(*arguments)
        self.assertEqual(done.returncode, 2, f"silt {arguments}: {done.stdout}{done.stderr}")
        self.assertIn(words, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def raises(self, words, call, *arguments, **named):
        """A silt.Error of one sentence that has these words."""
        import silt

        with self.assertRaises(silt.Error) as caught:
            call(*arguments, **named)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))
