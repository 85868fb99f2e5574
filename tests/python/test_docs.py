# silt - BSD-3-Clause, see LICENSE
"""The blocks of docs/python.md, run in turn in a folder as the page has it."""

import json
import os
import re
import shlex
import shutil
import tempfile
import unittest

from scenes import path, run

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "python.md")


class Page(unittest.TestCase):
    def setUp(self):
        self.folder, self.before = tempfile.mkdtemp(), os.getcwd()
        for name, source in (("out", "grains"), ("again", "again"), ("other", "other"), ("flow", "flow")):
            shutil.copytree(path(source), os.path.join(self.folder, name))
        summary = {"results": {"mass [kg]": 2}, "checks": [{"name": "a", "holds": True}]}
        for name in ("out", "again"):
            with open(os.path.join(self.folder, name, "summary.json"), "w") as file:
                json.dump(summary, file)
        with open(os.path.join(self.folder, "plane.csv"), "w") as file:
            file.write("x [m],z [m],speed [m/s]\n" + "".join(f"{k % 4},{k // 4},{k}\n" for k in range(12)))
        os.chdir(self.folder)

    def tearDown(self):
        os.chdir(self.before)
        shutil.rmtree(self.folder)

    def test_blocks(self):
        with open(PAGE, encoding="utf-8") as file:
            blocks = re.findall(r"```(python|sh)\n(.*?)```", file.read(), re.S)
        self.assertGreater(len(blocks), 8)
        names = {"__name__": "docs", "print": lambda *words: None}
        pictures = 0
        for language, block in blocks:
            if language == "python":
                exec(compile(block, "docs/python.md", "exec"), names)
                continue
            for line in block.strip().split("\n"):
                words = shlex.split(line)
                self.assertEqual(words[0], "silt", line)
                done = run(*words[1:])
                self.assertEqual((done.returncode, done.stderr), (0, ""), line + done.stdout)
                if "-o" in words:
                    pictures += 1
                    self.assertGreater(os.path.getsize(words[words.index("-o") + 1]), 3000, line)
        self.assertGreater(pictures, 7)
        self.assertGreater(os.path.getsize("own.png"), 3000)


if __name__ == "__main__":
    unittest.main()
