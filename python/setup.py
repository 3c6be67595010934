"""nevh: the wheel.  What is compiled stands in nevh_files, which make puts there.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import glob
import os
import re
import shutil
import subprocess

from setuptools import setup
from wheel.bdist_wheel import bdist_wheel


class Wheel(bdist_wheel):
    """One for every Python 3: nothing is compiled against it."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        platform = super().get_tag()[2]
        glibc = newest_glibc()
        if platform.startswith("linux_") and glibc:
            platform = "manylinux_%d_%d_%s" % (*glibc, platform[len("linux_"):])
        return "py3", "none", platform


def newest_glibc():
    """The newest version of glibc, (2, 36) for instance, whose symbols a file needs."""
    needed = set()
    for path in glob.glob("nevh_files/bin/*") + glob.glob("nevh_files/lib/*"):
        with open(path, "rb") as file:
            needed.update(re.findall(rb"\0GLIBC_(\d+)\.(\d+)", file.read()))
    return max((tuple(map(int, version)) for version in needed), default=None)


def stage():
    """From a build tree, where make wheel has not called this."""
    for tree in filter(None, (os.environ.get("NEVH_BUILD"), "../build", "..")):
        if os.path.exists(os.path.join(tree, "libnevh.la")):
            subprocess.run(["make", "-C", tree, "python/nevh_files"], check=True)
            made = os.path.join(tree, "python", "nevh_files")
            if os.path.realpath(made) != os.path.realpath("nevh_files"):
                shutil.copytree(made, "nevh_files")
            return
    raise SystemExit("nevh is not built: run ../quickstart first, or name its build "
                     "tree by NEVH_BUILD")


if not os.path.isdir("nevh_files"):
    stage()
setup(packages=["nevh", "nevh_files"],
      package_data={"nevh": ["py.typed", "*.pyi"], "nevh_files": ["**/*"]},
      cmdclass={"bdist_wheel": Wheel})
