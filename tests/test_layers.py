"""Layers, kept by a check that runs: kernels are numbers only, and the core needs no more than its four libraries."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import rigidarea

PACKAGE = Path(rigidarea.__file__).parent
ROOT = PACKAGE.parent
#: Of `geometry` what users hold: outlines, and what is let in.
OUTLINES = {"arcs", "outline", "measured", "solid", "simple", "stand_in", "gate", "svg_picture"}
KERNELS = sorted(
    path
    for room in ("geometry", "contact")
    for path in (PACKAGE / room).glob("*.py")
    if path.stem not in OUTLINES
)
#: What `import rigidarea` may bring with it; cffi and llvmlite come with pymunk and numba.
CORE = {"pymunk", "numpy", "numba", "llvmlite", "shapely", "cffi", "_cffi_backend"}
EXTRAS = (
    *("scipy", "matplotlib", "pygame", "imageio", "b2d", "pyb2d3", "dask", "distributed", "skfem"),
    *("svgelements", "contourpy", "PIL", "tomli_w", "gymnasium"),
)


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(p): p for p in PACKAGE.rglob("*.py")}


def statements(body: list[ast.stmt], inside_functions: bool) -> Iterator[ast.stmt]:
    """Statements that run on import, those under if, try and with included; with those in functions if asked."""
    for node in body:
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            continue
        yield node
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and not inside_functions:
            continue
        for field in ("body", "orelse", "finalbody"):
            yield from statements(getattr(node, field, []), inside_functions)
        for handler in getattr(node, "handlers", []):
            yield from statements(handler.body, inside_functions)


def imported_from(node: ast.ImportFrom, module: str, path: Path) -> str:
    """The absolute name of what a module imports from."""
    base = node.module or ""
    if node.level:
        package = module if path.name == "__init__.py" else module.rpartition(".")[0]
        up = package.split(".")[: len(package.split(".")) - node.level + 1]
        base = ".".join(up + ([base] if base else []))
    return base


def imports(path: Path, inside_functions: bool = False) -> set[str]:
    """Absolute names of the modules that a file imports."""
    module = name_of(path)
    found = set()
    for node in statements(ast.parse(path.read_text()).body, inside_functions):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = imported_from(node, module, path)
            found.add(base)
            found |= {f"{base}.{a.name}" for a in node.names if f"{base}.{a.name}" in MODULES}
    return found


def reached(start: set[str]) -> set[str]:
    """Everything that importing `start` imports, through all modules of this package."""
    seen: set[str] = set()
    todo = set(start)
    while todo:
        name = todo.pop()
        if name in seen:
            continue
        seen.add(name)
        if name in MODULES:
            todo |= imports(MODULES[name])
    return seen


def is_standard(name: str) -> bool:
    return name.partition(".")[0] in sys.stdlib_module_names


def test_there_are_kernels() -> None:
    assert {"predicates", "pool", "overlap", "tables", "broad", "meet", "row", "solve"} <= {
        p.stem for p in KERNELS
    }


@pytest.mark.parametrize("path", KERNELS, ids=lambda p: p.stem)
def test_kernels_know_numbers_only(path: Path) -> None:
    """numpy, what compiles them, other kernels, nothing else; not even inside a function."""
    for name in imports(path, inside_functions=True):
        ours = (
            name.split(".")[1:2] in (["geometry"], ["contact"], ["compile"])
            and name.split(".")[-1] not in OUTLINES
        )
        assert ours or is_standard(name) or name.partition(".")[0] == "numpy", name


@pytest.mark.parametrize(
    "rooms", [("geometry",), ("geometry", "contact"), ("geometry", "contact", "chipmunk")], ids="/".join
)
def test_numbers_do_not_know_who_attaches(rooms: tuple[str, ...]) -> None:
    """The walk goes one way (docs/architecture.md): no room imports those above it, nor what draws or compares."""
    below = {n for n in MODULES if n.split(".")[1:2] and n.split(".")[1] in rooms}
    assert below
    above = {"cases", "draw", "gallery", "study", "flexible", "__main__", "contact", "chipmunk"} - set(rooms)
    for module in below:
        for name in imports(MODULES[module], inside_functions=True):
            parts = name.split(".")
            assert parts[0] != "pygame", f"{module} imports pygame"
            assert parts[0] != "rigidarea" or parts[1:2] == [] or parts[1] not in above, (
                f"{module} imports {name}"
            )


def circle(graph: dict[str, set[str]]) -> list[str]:
    """One circle of the graph, first node repeated at its end; empty if there is none."""
    done: set[str] = set()

    def walk(node: str, path: list[str]) -> list[str]:
        if node in path:
            return [*path[path.index(node) :], node]
        if node in done:
            return []
        for after in sorted(graph[node]):
            if found := walk(after, [*path, node]):
                return found
        done.add(node)
        return []

    for node in sorted(graph):
        if found := walk(node, []):
            return found
    return []


def test_a_circle_is_found() -> None:
    assert circle({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == []
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]
    assert circle({"a": {"a"}}) == ["a", "a"]


def all_imports(module: str) -> set[str]:
    """Modules of this package that one imports in any way: at its top, in a function, for types alone.

    `from . import name` is an import of name, where that is a module and nothing that the package itself defines.
    """
    path = MODULES[module]
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = imported_from(node, module, path)
            names = {f"{base}.{alias.name}" for alias in node.names}
            found |= names & MODULES.keys() if names & MODULES.keys() else {base}
    return (found & MODULES.keys()) - {module}


def test_imports_have_no_circles() -> None:
    """Of any kind: those inside functions and those for types alone are circles too."""
    graph = {module: all_imports(module) for module in MODULES}
    assert circle(graph) == []


#: Lines of a file.
LONG = 400


def test_file_names_are_unique() -> None:
    """A name leads to one file (but `__init__`)."""
    names = [path.name for path in MODULES.values() if path.name != "__init__.py"]
    assert {name for name in names if names.count(name) > 1} == set()


def test_files_are_short() -> None:
    """One concern a file."""
    assert [name for name, path in MODULES.items() if path.read_text().count("\n") > LONG] == []


def test_the_core_needs_four_libraries() -> None:
    others = {n.partition(".")[0] for n in reached({"rigidarea"}) if not is_standard(n)} - {"rigidarea"}
    assert others <= CORE
    assert {"pymunk", "numpy", "numba", "shapely"} <= others  # the walk gets there


def test_what_users_bring_is_read_by_libraries_that_are_imported_when_needed() -> None:
    """`from rigidarea import bring` works without its extra; scene files in JSON need nothing of it."""
    others = {n.partition(".")[0] for n in reached({"rigidarea.bring"}) if not is_standard(n)} - {"rigidarea"}
    assert others <= CORE


def test_importing_the_core_imports_no_extras() -> None:
    """As it is, and not only as it reads: beyond what the four libraries bring (numba looks whether scipy is there)."""
    program = f"""
import importlib.util, sys, pymunk, numpy, shapely
if importlib.util.find_spec("numba"):  # not where a wheel has machine code
    import numba
before = set(sys.modules)
import rigidarea
print(sorted({set(EXTRAS)} & (set(sys.modules) - before)))
"""
    out = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert out.stdout.strip() == "[]"


def test_no_kernel_counts_rows_from_the_end() -> None:
    """`compile.whole` takes an index as it is; a literal is seen to be one where it stands alone, not in a tuple."""
    negative = [
        f"{path.name}:{node.lineno}"
        for path in MODULES.values()
        for function in ast.walk(ast.parse(path.read_text()))
        if isinstance(function, ast.FunctionDef)
        and any(re.match(r"(kernel|entry|callback)\b", ast.unparse(one)) for one in function.decorator_list)
        for node in ast.walk(function)
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Tuple)
        if any(isinstance(i, ast.UnaryOp) and isinstance(i.op, ast.USub) for i in node.slice.elts)
    ]
    assert negative == []


# --- what Python calls is an entry ---


def decorators(function: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
    return {re.split(r"\W", ast.unparse(one))[0] for one in function.decorator_list}


def parts(trees: dict[str, ast.Module]) -> set[tuple[str, str]]:
    """All `@kernel`s of modules: (module, name)."""
    return {
        (module, node.name)
        for module, tree in trees.items()
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and "kernel" in decorators(node)
    }


def called_by_python(trees: dict[str, ast.Module], paths: dict[str, Path]) -> list[str]:
    """Calls of `@kernel`s from what is Python when it runs: "module:line name"."""
    kernels, found = parts(trees), []
    for module, tree in trees.items():
        mine = {name: (module, name) for of, name in kernels if of == module}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                base = imported_from(node, module, paths[module])
                mine |= {a.asname or a.name: (base, a.name) for a in node.names}
        todo: list[ast.AST] = [tree]
        while todo:
            node = todo.pop()
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and decorators(node) & COMPILES:
                continue
            todo += ast.iter_child_nodes(node)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                if mine.get(node.func.id) in kernels:
                    found.append(f"{module}:{node.lineno} {node.func.id}")
    return sorted(found)


COMPILES = {"kernel", "entry", "njit", "callback", "vectorized"}


def test_a_kernel_that_python_calls_is_found() -> None:
    """Called beside a kernel, and by its own name or another; not called by what is compiled itself."""
    source = {
        "a": "@kernel(forceinline=True)\ndef f(x):\n    return x\n\n@entry\ndef g(x):\n    return f(x)\n",
        "b": "from a import f as h, g\n\ndef call():\n    return [g(1), h(2)]\n",
    }
    trees = {name: ast.parse(text) for name, text in source.items()}
    assert called_by_python(trees, {name: Path(f"{name}.py") for name in source}) == ["b:4 h"]


def test_python_calls_no_kernel() -> None:
    """What is made to be a part of others is compiled anew in each process that calls it: `@entry` is kept on disk."""
    trees = {name: ast.parse(path.read_text()) for name, path in MODULES.items()}
    assert len(parts(trees)) > 500
    assert called_by_python(trees, MODULES) == []
