# SPDX-License-Identifier: MIT
"""The build backend of pip install examples/python: packs vpl/__init__.py and the built library into one wheel.

Based on: PEP 517 (build backends) and PEP 427 (the format of wheels).
"""
import base64
import hashlib
import os
import re
import sysconfig
import zipfile

_HERE = os.path.dirname(os.path.abspath(__file__))
_ROOT = os.path.join(_HERE, "..", "..")


def _read(*path):
    with open(os.path.join(*path), "rb") as file:
        return file.read()


def _version():
    return re.search(rb'VERSION_STRING "(.*)"', _read(_ROOT, "include", "vpl", "base.h")).group(1).decode()


def _library():
    path = os.environ.get("VPL_LIBRARY", os.path.join(_ROOT, "build", "libvpl.so"))
    if not os.path.exists(path):
        raise SystemExit("%s does not exist: run make in the repository before, or set VPL_LIBRARY" % path)
    return _read(path)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version, platform = _version(), re.sub(r"[-.]", "_", sysconfig.get_platform())
    info = "vpl-%s.dist-info/" % version
    files = {
        "vpl/__init__.py": _read(_HERE, "vpl", "__init__.py"),
        "vpl/libvpl.so": _library(),
        info + "METADATA": ("Metadata-Version: 2.1\nName: vpl\nVersion: %s\nSummary: libvpl by ctypes\nLicense: MIT\n"
                            "Provides-Extra: numpy\nRequires-Dist: numpy ; extra == 'numpy'\n" % version).encode(),
        info + "WHEEL": ("Wheel-Version: 1.0\nGenerator: libvpl\nRoot-Is-Purelib: false\nTag: py3-none-%s\n"
                         % platform).encode(),
    }
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += "%s,sha256=%s,%d\n" % (name, digest, len(data))
    files[info + "RECORD"] = (record + info + "RECORD,,\n").encode()
    wheel = "vpl-%s-py3-none-%s.whl" % (version, platform)
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as packed:
        for name, data in files.items():
            packed.writestr(name, data)
    return wheel
