"""What `pip` makes of the sources: with a library machine code in a wheel of its platform, else numba is asked for."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from email.parser import Parser
from pathlib import Path

import pytest

pytest.importorskip("hatchling")
pytestmark = pytest.mark.checkout

ROOT = Path(__file__).parent.parent


def wheel_of(source: Path, folder: Path, **environment: str) -> zipfile.ZipFile:
    """As `pip install` makes it, but fetching nothing, and with no compiler in reach."""
    pip = [sys.executable, "-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-deps"]
    done = subprocess.run(
        [*pip, "--no-build-isolation", "-w", str(folder), str(source)],
        env={k: v for k, v in os.environ.items() if k != "RIGIDAREA_LIBRARY"} | {"PATH": ""} | environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    (made,) = folder.glob("*.whl")
    return zipfile.ZipFile(made)


def needs(wheel: zipfile.ZipFile) -> set[str]:
    """The packages that it asks for, extras left out."""
    (name,) = (n for n in wheel.namelist() if n.endswith(".dist-info/METADATA"))
    asked = Parser().parsestr(wheel.read(name).decode()).get_all("Requires-Dist", [])
    return {one.split(";")[0].rstrip("<>=.,0123456789 ") for one in asked if "extra ==" not in one}


CORE = {"pymunk", "numpy", "shapely"}


def test_an_sdist_without_a_linker_asks_for_numba(tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(tmp_path)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (source,) = tmp_path.glob("*.tar.gz")
    wheel = wheel_of(source, tmp_path)
    assert wheel.filename is not None and wheel.filename.endswith("-py3-none-any.whl")
    assert needs(wheel) == CORE | {"numba"}
    names = set(wheel.namelist())
    sources = {str(p.relative_to(ROOT).as_posix()) for p in (ROOT / "rigidarea").rglob("*.py")}
    assert sources | {"rigidarea/py.typed"} <= names
    beside = ("harness", "machine_code", "runtime.c")  # what judges the project, what makes machine code
    assert not [name for name in names if any(word in name for word in beside)]


def test_a_library_makes_a_wheel_of_its_platform_without_numba(tmp_path: Path) -> None:
    library = tmp_path / "library"
    library.mkdir()
    (library / "kernels.so").write_bytes(b"machine code")
    contents = {"library": "kernels.so", "platform": "manylinux_2_17_x86_64"}
    (library / "kernels.json").write_text(json.dumps(contents))
    wheel = wheel_of(ROOT, tmp_path, RIGIDAREA_LIBRARY=str(library))
    assert wheel.filename is not None and wheel.filename.endswith("-py3-none-manylinux_2_17_x86_64.whl")
    assert needs(wheel) == CORE
    assert wheel.read("rigidarea/compile/kernels.so") == b"machine code"
    (name,) = (n for n in wheel.namelist() if n.endswith(".dist-info/WHEEL"))
    assert "Root-Is-Purelib: false" in wheel.read(name).decode()
