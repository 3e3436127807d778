"""Which bodies and shapes a space has, and whose callbacks: as its tables know them.

pymunk tells of what comes and goes one by one (`space`), and machine code enters it when the next frame begins, or
before; what does not move at once. Should Chipmunk know of others, the whole space is looked through.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..chipmunk import address_of
from ..outline import Outline
from .arrays import Store
from .geometry import PLACES

if TYPE_CHECKING:
    from .hook import Hook

_STATIC = pymunk.Body.STATIC


class Register:
    """The shapes of one attached space that are in its tables. It keeps no space alive: that is handed over."""

    def __init__(self, store: Store, hook: Hook) -> None:
        from . import entering

        self._store = store
        self._state = store.state[0]
        self._at = store.state.ctypes.data
        self._hook = hook
        self._where = np.array([int(self._state[name]) for name in PLACES], np.int64)
        self._calls = {
            name: ffi.cast(kind, getattr(entering, name).address)
            for name, kind in (
                ("shapes_come", "void(*)(uintptr_t, uintptr_t, uintptr_t, long long)"),
                ("shapes_go", "void(*)(uintptr_t, uintptr_t, long long)"),
                ("bodies_come", "void(*)(uintptr_t, uintptr_t, long long, long long)"),
                ("bodies_go", "void(*)(uintptr_t, uintptr_t, long long)"),
                ("placed_anew", "void(*)(uintptr_t, uintptr_t, long long)"),
            )
        }
        self.shapes: dict[int, pymunk.Shape] = {}  # by Chipmunk's id
        self._new: dict[pymunk.Shape, None] = {}  # not entered yet
        self._gone: list[int] = []  # ids of shapes that are entered still
        self._bodies: dict[pymunk.Body, None] = {}  # not entered yet
        self._left: list[int] = []  # bodies that are entered still

    def _pend(self) -> None:
        """There is something to enter, or to forget, before the next frame."""
        if self._state["pending"] == 0:
            self._state["pending"] = 1

    # --- what pymunk tells ---

    def shape_came(self, shape: pymunk.Shape) -> None:
        """A shape has been added: what does not move counts as it is now, until it is reindexed, as in pymunk."""
        self._pend()
        self._new[shape] = None
        if shape.body is not None and shape.body.body_type == _STATIC:
            try:
                heads = self._outlines([shape])
                self.forget()
                self._enter([shape], heads)
            except (
                ValueError,
                MemoryError,
            ):  # said when the space is stepped: pymunk is in the midst of adding
                return
            del self._new[shape]

    def shape_goes(self, shape: pymunk.Shape) -> None:
        """A shape is about to be removed."""
        if shape in self._new:
            del self._new[shape]
        else:
            self._gone.append(shape._hashid)
        self._pend()

    def body_came(self, body: pymunk.Body) -> None:
        """A body has been added."""
        self._bodies[body] = None
        self._pend()

    def body_goes(self, body: pymunk.Body) -> None:
        """A body is about to be removed."""
        if body in self._bodies:
            del self._bodies[body]
        else:
            self._left.append(address_of(body._body))
            self._hook.release(body)
        self._pend()

    def reread(self, shapes: Iterable[pymunk.Shape]) -> None:
        """These shapes have been reindexed: those of a changed geometry are read again, and what is static is where it
        is now.
        """
        known = [shape for shape in shapes if self.shapes.get(shape._hashid) is shape]
        rows, slots = self._store.known_shapes, self._store.slots
        for shape in known:
            if self._outlines([shape])[0] != rows["outline"][slots[shape._hashid]]:
                self.refresh(shape)
                rows = self._store.known_shapes
        bodies = {address_of(shape.body._body) for shape in known if shape.body is not None}
        if bodies:
            self._call("placed_anew", bodies)

    def refresh(self, shape: pymunk.Shape) -> None:
        """Read a shape's geometry again: `AreaContact.refresh`.

        Raises ValueError for a shape that is not entered, or that has no area now.
        """
        if not isinstance(shape, pymunk.Shape) or self.shapes.get(shape._hashid) is not shape:
            raise ValueError(f"shape must be one that the space has stepped with, got {shape!r:.80}")
        self._outlines([shape])  # says what is wrong with it while nothing has changed
        self._call("shapes_go", [shape._hashid])
        self._enter([shape])

    # --- entering ---

    def update(self, space: pymunk.Space) -> None:
        """Bring the tables up to what the space holds: bodies, shapes, whose callbacks there are."""
        state = self._state
        told = state["pending"] == 1
        count = len(self.shapes) + len(self._new) - len(self._gone)
        pending = state["pending"]
        if count != len(space._shapes) or pending == 2:
            self._look_through(space)
        new = list(self._new)
        heads = self._outlines(new)  # says what is wrong with one while nothing has changed
        state["pending"] = 2  # until all is done: whoever is interrupted looks through the space
        self.forget()
        if self._bodies:
            addresses = [address_of(body._body) for body in self._bodies]
            self._store.room(0, len(addresses), 0)
            # (who comes later is moved by Chipmunk in its first frame, so that its index knows where that takes it)
            self._call("bodies_come", addresses, state["shape_count"] < 0 and not state["explicit"])
            for body in self._bodies:
                self._hook.hold(body)
            self._bodies.clear()
        if pending >= 2:
            self._enter_partners(space)
        self._enter(new, heads)
        self._new.clear()
        if not told:  # what begins a frame has noticed something else, of callbacks perhaps
            for name, value in self._hear(space).items():
                state[name] = value
        state["shape_counter"] = lib.cpSpaceGetShapeIDCounter(space._space)
        state["shape_count"] = len(self.shapes)
        state["pending"] = 0

    def forget(self) -> None:
        """What has gone is not in the tables any more: nothing of it is read or written from now on."""
        if self._gone:
            self._call("shapes_go", self._gone)
            for ident in self._gone:
                self.shapes.pop(ident, None)
            self._gone.clear()
            try:
                self._store.tidy()
            except MemoryError:  # another time: pymunk is in the midst of removing
                pass
        if self._left:
            self._call("bodies_go", self._left)
            self._left.clear()

    def _look_through(self, space: pymunk.Space) -> None:
        """What there is that pymunk has not told of, and what is no more."""
        present = {shape._hashid: shape for shape in space._shapes}
        rows = self._store.known_shapes
        known = set(rows["ident"][rows["outline"] >= 0].tolist())
        self.shapes = {ident: shape for ident, shape in present.items() if ident in known}
        self._gone = [ident for ident in known if ident not in present]
        self._new = {shape: None for ident, shape in present.items() if ident not in known}
        bodies = {address_of(body._body): body for body in space._bodies}
        held = {address_of(body._body) for joint in space._constraints for body in (joint.a, joint.b)}
        found = self._store.tables.bodies
        entered = set(found["address"][found["entered"] == 1].tolist())
        self._left = [address for address in entered if address not in bodies and address not in held]
        self._bodies = {body: None for address, body in bodies.items() if address not in entered}

    def _enter_partners(self, space: pymunk.Space) -> None:
        """Bodies that joints hold and that are not among the space's: its static one, those that the user moves."""
        held = {address_of(body._body) for joint in space._constraints for body in (joint.a, joint.b)}
        addresses = sorted(address for address in held if self._store.row_of(address) < 0)
        self._store.room(0, len(addresses), 0)
        self._call("bodies_come", addresses, 0)

    def _outlines(self, shapes: Sequence[pymunk.Shape]) -> np.ndarray:
        """The numbers of the shapes' outlines in the pool, in which they are then. ValueError if one has no area."""
        heads = np.zeros(len(shapes), np.int32)
        plain = [i for i, shape in enumerate(shapes) if not _given(shape)]
        chosen = shapes if len(plain) == len(shapes) else [shapes[i] for i in plain]
        addresses = _words(address_of(shape._shape) for shape in chosen)
        heads[plain], bad = self._store.read(addresses, self._where)
        if bad >= 0:
            Outline.from_pymunk(chosen[bad])  # says what is wrong
            raise ValueError(f"expected shapes with an area, got {chosen[bad]!r:.80}")
        if len(plain) < len(shapes):
            for i, shape in enumerate(shapes):
                if _given(shape):
                    heads[i] = self._given(Outline.from_pymunk(shape))
        return heads

    def _given(self, outline: Outline) -> int:
        """The number in the pool of an outline that somebody has made."""
        head = self._store.outline(outline, outline.smallest_extent)
        if outline.mirror is not None:
            self._store.forms.mirror[head] = self._store.outline(outline.mirror, outline.smallest_extent)
        return head

    def _enter(self, shapes: Sequence[pymunk.Shape], heads: np.ndarray | None = None) -> None:
        """Enter shapes into the tables, whose outlines have these numbers."""
        if not shapes:
            return
        heads = self._outlines(shapes) if heads is None else heads
        idents = [shape._hashid for shape in shapes]
        bodies = {address_of(shape.body._body) for shape in shapes if shape.body is not None}
        unknown = sum(self._store.row_of(address) < 0 for address in bodies)  # static ones are in no list
        self._store.room(len(shapes), unknown, max(idents))
        addresses = _words(address_of(shape._shape) for shape in shapes)
        self._calls["shapes_come"](self._at, addresses.ctypes.data, heads.ctypes.data, len(shapes))
        self.shapes.update(zip(idents, shapes))

    def _call(self, name: str, values: Iterable[int], *more: int) -> None:
        words = ffi.new("uintptr_t[]", list(values))  # (numpy takes ten times as long for one)
        self._calls[name](self._at, ffi.cast("uintptr_t", words), len(words), *more)

    def largest(self) -> float:
        """The largest side (length) of the bounding boxes of the shapes that move; 1 if there are none."""
        tables = self._store.tables
        shapes = self._store.known_shapes
        moves = (
            (shapes["outline"] >= 0)
            & (tables.bodies["mobile"][shapes["body"]] == 1)
            & (shapes["sensor"] == 0)
        )
        sides = [
            shapes[high][moves] - shapes[low][moves] for low, high in (("left", "right"), ("bottom", "top"))
        ]
        return float(max((side.max() for side in sides if len(side)), default=1.0))

    def _hear(self, space: pymunk.Space) -> dict[str, int]:
        """Take down which collision types have callbacks of the user's, that may say no.

        Returns facts by which it is known whether there are others.
        """
        everywhere = space._handlers.get((None, None))
        to_all = everywhere is not None and any(
            getattr(everywhere, phase) is not None
            for phase in ("begin", "pre_solve", "post_solve", "separate")
        )
        keys = [key for key in space._handlers if key != (None, None)]
        alone = _words({a for a, b in keys if b is None})
        pairs = _words({kind for a, b in keys if b is not None for kind in (a, b)})
        store, state = self._store, self._state
        before = bool(state["heard_all"]), store.heard_alone.tolist(), store.heard_pairs.tolist()
        if before != (to_all, alone.tolist(), pairs.tolist()):
            new = copy.copy(store)
            new.heard_alone, new.heard_pairs = alone, pairs
            store.publish(new, heard_all=to_all, heard_epoch=int(state["heard_epoch"]) + 1)
        entries = ffi.cast("unsigned int **", address_of(space._space) + int(state["space_handlers"]))
        return {"handler_count": int(entries[0][0]), **self._hook.callbacks()}


def _given(shape: pymunk.Shape) -> bool:
    """Whether somebody has put an outline on a shape."""
    return isinstance(getattr(shape, "outline", None), Outline)


def _words(values: Iterable[Any]) -> np.ndarray:
    return np.array(list(values), np.uint64)
