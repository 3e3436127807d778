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

from ..geometry.outline import Outline, outline_on
from .arrays import Store
from .outline_pool import drop_unused_outlines, enter_outline, read_outlines
from .structs import address_of

if TYPE_CHECKING:
    from .hook import Hook

_STATIC = pymunk.Body.STATIC


class Register:
    """The shapes of one attached space that are in its tables. It keeps no space alive: that is handed over."""

    def __init__(self, store: Store, hook: Hook) -> None:
        from . import entering

        self._store = store
        self._state = store.state[0]
        # pointers: reading a field of a record takes forty times as long
        fields = (store.state[name] for name in ("pending", "shape_counter", "shape_count"))
        self._pending, self._counter, self._count = (ffi.cast("long long *", at.ctypes.data) for at in fields)
        self._hook = hook
        self._shapes_come = ffi.cast(
            "long long(*)(uintptr_t, void *, int *, long long)", entering.shapes_come.address
        )
        self._shape_goes = ffi.cast("void(*)(uintptr_t, uintptr_t)", entering.shape_goes.address)
        self._bodies_come = ffi.cast(
            "long long(*)(uintptr_t, void *, long long, long long)", entering.bodies_come.address
        )
        self._body_goes = ffi.cast("void(*)(uintptr_t, void *, long long)", entering.body_goes.address)
        self._placed_anew = ffi.cast("void(*)(uintptr_t, void *, long long)", entering.placed_anew.address)
        self.shapes: dict[int, pymunk.Shape] = {}  # by Chipmunk's id
        self.proxies: set[int] = set()  # ids of those whose outline Chipmunk does not see
        self._new: dict[pymunk.Shape, None] = {}  # not entered yet
        self._bodies: dict[pymunk.Body, None] = {}  # not entered yet

    def _pend(self) -> None:
        """There is something to enter before the next frame (what goes is noted in machine code)."""
        if self._pending[0] == 0:
            self._pending[0] = 1

    # --- what pymunk tells ---

    def shape_came(self, shape: pymunk.Shape) -> None:
        """A shape has been added: what does not move counts as it is now, until it is reindexed, as in pymunk."""
        self._pend()
        self._new[shape] = None
        body = shape.body
        if body is not None and body.body_type == _STATIC:
            try:
                drop_unused_outlines(self._store)
                self._enter([shape], *self._outlines([shape]))
            # said when the space is stepped: pymunk is in the midst of adding
            except (ValueError, MemoryError):
                return
            del self._new[shape]

    def shape_went(self, shape: pymunk.Shape, ident: int) -> None:
        """A shape has been removed: nothing of it is read or written from now on. ident: its id until then."""
        if shape in self._new:
            del self._new[shape]
        else:
            self._forget(ident)

    def _forget(self, ident: int) -> None:
        self._shape_goes(self._store.at, ident)
        self.shapes.pop(ident, None)
        self.proxies.discard(ident)

    def body_came(self, body: pymunk.Body) -> None:
        """A body has been added."""
        self._bodies[body] = None
        self._pend()

    def body_goes(self, body: pymunk.Body) -> None:
        """A body is about to be removed: it has its position function back."""
        if body in self._bodies:
            del self._bodies[body]
        else:
            self._hook.held.discard(body)
            self._body_goes(self._store.at, body._body, True)

    def look_again(self) -> None:
        """Something has gone in the midst of a step: the whole space is looked through before the next."""
        self._pending[0] = 2

    def reread(self, shapes: Iterable[pymunk.Shape]) -> None:
        """These shapes have been reindexed: those of a changed geometry are read again, and what is static is where it
        is now.
        """
        known = [shape for shape in shapes if self.shapes.get(shape._hashid) is shape]
        rows, slots = self._store.known_shapes, self._store.slots
        for shape in known:
            if self._outlines([shape])[1][0] != rows["outline"][slots[shape._hashid]]:
                self.refresh(shape)
                rows = self._store.known_shapes
        bodies = {shape.body: None for shape in known if shape.body is not None}
        self._placed_anew(self._store.at, _pointers(body._body for body in bodies), len(bodies))

    def refresh(self, shape: pymunk.Shape) -> None:
        """Read a shape's geometry again: `AreaContact.refresh`.

        Raises ValueError for a shape that is not entered, or that has no area now.
        """
        if not isinstance(shape, pymunk.Shape) or self.shapes.get(shape._hashid) is not shape:
            raise ValueError(f"shape must be one that the space has stepped with, got {shape!r:.80}")
        read = self._outlines([shape])  # says what is wrong with it while nothing has changed
        self._shape_goes(self._store.at, shape._hashid)
        self._enter([shape], *read)

    # --- entering ---

    def update(self, space: pymunk.Space) -> None:
        """Bring the tables up to what the space holds: bodies, shapes, whose callbacks there are."""
        state = self._state
        pending = self._pending[0]
        if len(self.shapes) + len(self._new) != len(space._shapes) or pending == 2:
            self._look_through(space)
        drop_unused_outlines(self._store)
        new = list(self._new)
        read = self._outlines(new)  # says what is wrong with one while nothing has changed
        self._pending[0] = 2  # until all is done: whoever is interrupted looks through the space
        if self._bodies:
            # (who comes later is moved by Chipmunk in its first frame, so that its index knows where that takes it)
            held = self._count[0] < 0 and not state["explicit"]
            self._hook.held.update(self._bodies)
            self._enter_bodies([body._body for body in self._bodies], held)
            self._bodies.clear()
        if (
            pending >= 2
        ):  # bodies that joints hold and that are not among the space's: its static one, the user's
            self._enter_bodies(_held(space), False)
        self._enter(new, *read)
        self._new.clear()
        if pending != 1:  # what begins a frame has noticed something else, of callbacks perhaps
            for name, value in self._hear(space).items():
                state[name] = value
        self._counter[0] = lib.cpSpaceGetShapeIDCounter(space._space)
        self._count[0] = len(self.shapes)
        self._pending[0] = 0

    def _look_through(self, space: pymunk.Space) -> None:
        """What there is that pymunk has not told of, and what is no more."""
        present = {shape._hashid: shape for shape in space._shapes}
        rows = self._store.known_shapes
        known = set(rows["ident"][rows["outline"] >= 0].tolist())
        for ident in known - present.keys():
            self._forget(ident)
        self.shapes = {ident: shape for ident, shape in present.items() if ident in known}
        self._new = {shape: None for ident, shape in present.items() if ident not in known}
        bodies = {address_of(body._body): body for body in space._bodies}
        held = {address_of(body) for body in _held(space)}
        found = self._store.tables.bodies
        entered = set(found["address"][found["entered"] == 1].tolist())
        for address in entered - bodies.keys() - held:
            self._body_goes(self._store.at, ffi.cast("void *", address), False)
        self._bodies = {body: None for address, body in bodies.items() if address not in entered}

    def _enter_bodies(self, bodies: Iterable[Any], hold: bool) -> None:
        """Enter bodies (cffi pointers) that are not entered yet."""
        addresses = _pointers(bodies)
        done, n = 0, len(addresses)
        while (
            done < n
            and (done := done + self._bodies_come(self._store.at, addresses + done, n - done, hold)) < n
        ):
            self._store.grow()

    def _outlines(self, shapes: Sequence[pymunk.Shape]) -> tuple[Any, Any, list[Outline | None]]:
        """Chipmunk's addresses of shapes, the numbers in the pool of their outlines, in which they are then, and the
        outlines that somebody has put on them. ValueError if one has no area.
        """
        addresses = ffi.new("void *[]", [shape._shape for shape in shapes])
        given = [outline_on(shape) for shape in shapes]
        heads = ffi.new("int[]", [self._packed(one) if one else -1 for one in given])
        bad = read_outlines(self._store, address_of(addresses), address_of(heads), len(shapes))
        if bad >= 0:
            try:
                Outline.from_pymunk(shapes[bad])  # says what is wrong
            except ValueError as error:
                raise ValueError(f"{_named(shapes[bad])}: {error}") from None
            raise ValueError(f"expected shapes with an area, got {shapes[bad]!r:.80}")
        return addresses, heads, given

    def _packed(self, outline: Outline) -> int:
        """The number in the pool of an outline that somebody has put on a shape."""
        head = enter_outline(self._store, outline, outline.smallest_extent)
        if outline.mirror is not None:
            self._store.forms.mirror[head] = enter_outline(
                self._store, outline.mirror, outline.smallest_extent
            )
        return head

    def _enter(
        self, shapes: Sequence[pymunk.Shape], addresses: Any, heads: Any, given: list[Outline | None]
    ) -> None:
        """Enter shapes into the tables (`_outlines`)."""
        done, n = 0, len(shapes)
        while done < n:
            done += self._shapes_come(self._store.at, addresses + done, heads + done, n - done)
            if done < n:
                self._store.grow()
        idents = [shape._hashid for shape in shapes]
        self.shapes.update(zip(idents, shapes))
        proxies = [ident for ident, one in zip(idents, given) if one and one.proxied]
        if proxies:
            self._store.known_shapes["proxy"][self._store.slots[proxies]] = 1
            self.proxies.update(proxies)

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


def _held(space: pymunk.Space) -> set[Any]:
    """Chipmunk's bodies that joints hold."""
    return {body._body for joint in space._constraints for body in (joint.a, joint.b)}


def _pointers(cdata: Iterable[Any]) -> Any:
    return ffi.new("void *[]", list(cdata))


def _words(values: Iterable[Any]) -> np.ndarray:
    return np.array(list(values), np.uint64)


def _named(shape: pymunk.Shape) -> str:
    """Which shape of its space it is, and of which body."""
    space, body, kind = shape.space, shape.body, type(shape).__name__
    if space is None or body is None:
        return kind
    bodies = list(space.bodies)
    whose = f"bodies[{bodies.index(body)}]" if body in bodies else "a body that is not in the space"
    if body is space.static_body:
        whose = "static_body"
    return f"shapes[{list(space.shapes).index(shape)}], a {kind} of {whose}"
