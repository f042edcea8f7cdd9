# SPDX-License-Identifier: MIT
"""python3 test_vpl.py VPL SCENE: the package gives the bits of the program VPL, and its errors are exceptions."""
import os
import subprocess
import sys
import tempfile
import unittest
import warnings

import vpl

program, path = sys.argv[1], sys.argv[2]
OPTIONS = {"method": "keller", "particles": 80, "passes": 4, "size": (32, 18)}


def floats(picture):
    return picture.tobytes()


class Package(unittest.TestCase):
    def test_pictures_have_the_bits_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            out, mine = os.path.join(folder, "out.pfm"), os.path.join(folder, "mine.pfm")
            subprocess.run([program, "render", path, "--quiet", "-o", out, "--method", "keller", "--particles", "80",
                            "--passes", "4", "--size", "32x18"], check=True)
            vpl.write(vpl.render(path, **OPTIONS), mine)
            with open(out, "rb") as a, open(mine, "rb") as b:
                self.assertEqual(a.read(), b.read())

    def test_shapes(self):
        got = vpl.render(path, layers=("depth", "normal"), **OPTIONS)
        self.assertEqual([got[name].shape for name in ("picture", "depth", "normal")],
                         [(18, 32, 3), (18, 32), (18, 32, 3)])
        self.assertEqual(floats(got["picture"]), floats(vpl.render(path, **OPTIONS)))

    def test_failures_are_sentences(self):
        with self.assertRaisesRegex(OSError, "nowhere.json"):
            vpl.Scene("nowhere.json")
        with self.assertRaisesRegex(ValueError, "particles"):
            vpl.render(path, particles="many")
        with self.assertRaisesRegex(ValueError, "paticles"):
            vpl.render(path, paticles=5)
        with self.assertRaisesRegex(ValueError, "camera"):
            vpl.render(path, camera=99)

    def test_a_stopped_render_returns_the_picture_so_far(self):
        got = vpl.render(path, progress=lambda fraction: fraction < 0.6, **OPTIONS)
        self.assertEqual(got.shape, (18, 32, 3))
        with self.assertRaises(KeyboardInterrupt):
            vpl.render(path, progress=lambda fraction: False, **OPTIONS)

    def test_an_exception_in_progress_comes_out(self):
        def broken(fraction):
            raise RuntimeError("broken")
        with self.assertRaisesRegex(RuntimeError, "broken"):
            vpl.render(path, progress=broken, **OPTIONS)

    def test_warnings_are_warnings(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            vpl.render(path, method="keller", particles=20, max_error=0.0001, passes=1, size=(16, 9))
        self.assertTrue(any("error" in str(warning.message) for warning in caught))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
