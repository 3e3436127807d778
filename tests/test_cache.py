"""The compile cache: damaged files are compiled again, nobody else's folder is used, waiting is announced."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

numba = pytest.importorskip("numba")
cache = pytest.importorskip("rigidarea.compile.cache")

ROOT = Path(__file__).parent.parent

DAMAGES = {
    "empty": lambda data: b"",
    "cut short": lambda data: data[: len(data) // 2],
    "garbage": lambda data: bytes(reversed(data)),
    "one bit": lambda data: data[:-20] + bytes([data[-20] ^ 1]) + data[-19:],
}

TINY = """
import ctypes
from rigidarea.compile.jit import callback, njit

@njit
def twice(x):
    return 2 * x

@callback("float64(float64)")
def plus_one(x):
    return x + 1.0

print(twice(21), ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(plus_one.address)(1.0))
"""


@pytest.fixture
def quiet(monkeypatch, capsys):
    monkeypatch.setattr(cache, "notice", cache.Notice())
    return capsys


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_a_damaged_file_counts_as_missing(damage, suffix, tmp_path, quiet):
    files = cache.CheckedFile(str(tmp_path), "kernel", "stamp")
    files.save("key", {"code": b"x" * 100})
    assert files.load("key") == {"code": b"x" * 100}
    (path,) = tmp_path.glob(f"*{suffix}")
    path.write_bytes(DAMAGES[damage](path.read_bytes()))
    assert files.load("key") is None
    assert files.load("key") is None
    said = quiet.readouterr().err.splitlines()
    assert said == [f"rigidarea: compiled code in {tmp_path} is damaged; compiling it again"]  # one line
    files.save("key", {"code": b"y"})
    assert files.load("key") == {"code": b"y"}


def test_another_version_of_the_source_is_no_damage(tmp_path, quiet):
    cache.CheckedFile(str(tmp_path), "kernel", "stamp").save("key", 1)
    assert cache.CheckedFile(str(tmp_path), "kernel", "newer").load("key") is None
    assert cache.CheckedFile(str(tmp_path), "kernel", "stamp").load("other key") is None
    assert quiet.readouterr().err == ""


def test_what_cannot_be_kept_is_said_once(tmp_path, quiet):
    files = cache.CheckedFile(str(tmp_path / "gone"), "kernel", "stamp")
    files.save("key", 1)
    files.save("key", 2)
    (said,) = quiet.readouterr().err.splitlines()
    assert said.startswith("rigidarea: compiled code cannot be kept: ")


def tiny(folder: Path, kept: Path | None = None) -> tuple[str, str]:
    (folder / "tiny.py").write_text(TINY)
    os.utime(folder / "tiny.py", (1e9, 1e9))  # the same file to numba, which looks at its date
    program = f"import rigidarea; rigidarea.__path__.append({str(folder)!r}); import rigidarea.tiny"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(kept or folder / "cache"), "PYTHONPATH": str(ROOT)}
    environment.pop("NUMBA_DISABLE_JIT", None)
    environment["RIGIDAREA_BACKEND"] = "compiled"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def test_first_use_says_what_it_waits_for_and_damage_is_mended(tmp_path):
    out, said = tiny(tmp_path)
    assert out == "42 2.0\n"
    assert said.startswith(f"rigidarea: compiling once (all of it: {cache.USUALLY}), kept in ")
    assert str(tmp_path) in said and said.count("compiling") == 1 and said.endswith(" s\n")
    assert tiny(tmp_path) == ("42 2.0\n", "")  # nothing compiles, nothing is said
    files = sorted((tmp_path / "cache").rglob("*.nb[ci]"))
    assert len(files) == 4  # index and data of both
    index = next(path for path in files if path.suffix == ".nbi")
    data = next(
        path
        for path in files
        if path.suffix == ".nbc" and path.name.split("-")[0] != index.name.split("-")[0]
    )
    for path in (index, data):
        path.write_bytes(b"\x80\x05garbage")
    out, said = tiny(tmp_path)
    assert out == "42 2.0\n"
    assert said.count("is damaged; compiling it again") == 1
    assert tiny(tmp_path) == ("42 2.0\n", "")


def test_the_notice_shows_that_it_is_alive(monkeypatch):
    written: list[str] = []  # not capsys: emptying it while the thread writes loses words
    monkeypatch.setattr(cache, "_write", written.append)
    monkeypatch.setattr(cache.time, "sleep", lambda seconds, sleep=time.sleep: sleep(0.02 * seconds))
    notice = cache.Notice()
    notice.folder = "there"
    notice.begin()
    notice.begin()  # what it calls
    notice.end()
    deadline = time.monotonic() + 60
    while " 10 s " not in written and time.monotonic() < deadline:
        time.sleep(0.05)
    notice.end()
    while not written[-1].endswith("s\n") and time.monotonic() < deadline:
        time.sleep(0.05)
    said = "".join(written)
    assert said.startswith(
        f"rigidarea: compiling once (all of it: {cache.USUALLY}), kept in there ......... 10 s "
    )
    assert said.count("\n") == 1


# --- whose folder it is ---


@pytest.fixture
def homeless(tmp_path, monkeypatch):
    """No cache folder but the temporary one."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null/nothing")
    monkeypatch.setenv("HOME", "/dev/null")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    if not hasattr(os, "getuid"):
        pytest.skip("no owners here")
    return tmp_path / f"rigidarea-{os.getuid()}"


def mode(path: str | Path) -> int:
    return os.stat(path).st_mode & 0o777


def test_the_temporary_folder_is_private_and_kept(homeless):
    found = cache.folder("abc")
    assert Path(found) == homeless / "abc" and mode(homeless) == 0o700
    assert cache.folder("abc") == found


@pytest.mark.parametrize("how", ["open to others", "a link", "a file", "somebody else's"])
def test_a_folder_that_others_could_fill_is_not_used(how, homeless, tmp_path):
    if how == "open to others":
        homeless.mkdir()
        homeless.chmod(0o755)
    elif how == "a link":
        (tmp_path / "theirs").mkdir(mode=0o700)
        homeless.symlink_to(tmp_path / "theirs")
    elif how == "a file":
        homeless.write_text("")
    else:
        homeless.mkdir(mode=0o700)
        if os.getuid() != 0:
            pytest.skip("only root can give a folder away")
        os.chown(homeless, 12345, 12345)
    found = Path(cache.folder("abc"))
    assert homeless not in found.parents and found.parent == tmp_path
    assert mode(found) == 0o700 and cache.is_private(str(found))
    assert found != Path(cache.folder("abc"))  # nobody can know the name beforehand


def test_the_users_own_folder_comes_first(homeless, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "mine"))
    assert cache.folder("abc") == str(tmp_path / "mine" / "rigidarea" / "abc")


def test_another_environment_compiles_nothing(tmp_path):
    """The cache goes by what is compiled, not by where it lies."""
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    assert "compiling" in tiny(tmp_path / "here", tmp_path / "cache")[1]
    assert tiny(tmp_path / "there", tmp_path / "cache") == ("42 2.0\n", "")


def test_a_module_is_compiled_again_when_what_it_imports_changes(tmp_path):
    from rigidarea.compile import compiled as jit

    def imported(source: str) -> set[str]:
        (tmp_path / "some.py").write_text(source)
        jit._imports.cache_clear()
        return {path.name for path in jit._imports(tmp_path / "some.py")[1]}

    assert imported("from rigidarea.geometry.arc import on_arc") == {"arc.py"}
    assert imported(
        "def f():\n    from rigidarea.geometry import (\n        arc,\n        disc,\n    )\n"
    ) == {
        "arc.py",
        "disc.py",
        "__init__.py",
    }
    kernels = ROOT / "rigidarea" / "contact"
    assert kernels / "tables.py" in jit._imports(kernels / "row.py")[1]
    assert kernels / "space_record.py" in jit._imports(ROOT / "rigidarea" / "chipmunk" / "record.py")[1]
    folders = {jit.cache_folder(path) for path in kernels.glob("*.py")}
    assert len(folders) == len(list(kernels.glob("*.py")))  # names and contents differ
