"""Which bodies and shapes a space has, and whose callbacks: as its tables know them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..chipmunk import address_of
from ..outline import Outline
from .arrays import Store

if TYPE_CHECKING:
    from .hook import Hook


class Register:
    """The shapes of one attached space that are in its tables. It keeps no space alive: that is handed over."""

    def __init__(self, store: Store, hook: Hook) -> None:
        self._store = store
        self._state = store.state[0]
        self._hook = hook
        self._added: dict[int, tuple[Outline, Any]] = {}
        self.stale = False  # something has come or gone since the last `update`

    @property
    def shapes(self) -> dict[int, pymunk.Shape]:
        """By Chipmunk's id."""
        return self._store.shapes

    def update(self, space: pymunk.Space) -> None:
        """Bring the tables up to what the space holds: bodies, shapes, whose callbacks there are."""
        store = self._store.draft()
        present: dict[int, Any] = {shape._hashid: shape for shape in space.shapes if shape.body is not None}
        # not space.static_body, which makes one where there is none
        still = [] if space._static_body is None else [space._static_body]
        bodies = {address_of(body._body): body for body in (*space.bodies, *still)}
        for shape in present.values():
            bodies.setdefault(address_of(shape.body._body), shape.body)
        for constraint in space.constraints:
            for body in (constraint.a, constraint.b):
                bodies.setdefault(address_of(body._body), body)
        gone = {
            *(store.shapes.keys() - present.keys()),
            *(i for i, shape in present.items() if i in store.shapes and not self._same(store, i, shape)),
        }
        store.forget(gone, store.known_bodies() - bodies.keys())
        for ident in gone:
            del store.shapes[ident], store.forms[ident]
        store.owners = bodies
        for address in bodies:
            store.body(address)
        for ident, shape in present.items():
            if ident not in store.shapes:
                self._take(store, shape)
        facts = self._hear(store, space)
        store.settle()
        counter = lib.cpSpaceGetShapeIDCounter(space._space)
        self._store.publish(store, shape_counter=counter, shape_count=len(present), **facts)
        self._added.clear()
        if not self._state["explicit"]:
            for body in space.bodies:
                self._hook.hold(body, not space._locked)
        self.stale = space._locked  # within a step no body's function is changed

    @staticmethod
    def _same(store: Store, ident: int, shape: Any) -> bool:
        """Whether a shape is the one that the tables have by its number, on the same body."""
        row = store.tables.shapes[store.slots[ident]]
        return store.shapes[ident] is shape and row["body"] == store.row_of(address_of(shape.body._body))

    def leaves(self, body: pymunk.Body) -> None:
        """A body is removed: nothing of it is read or written from now on."""
        self.stale = True
        self._state["shape_count"] = -1  # also for a step that has gone past the attached space's own
        self._hook.release(body)
        self._store.leave(address_of(body._body))

    def came(self, shape: pymunk.Shape) -> None:
        """A shape has been added: what does not move counts as it is now, until it is reindexed, as in pymunk."""
        self.stale = True
        if shape.body is not None and shape.body.body_type == pymunk.Body.STATIC:
            try:
                self._added[shape._hashid] = Outline.from_pymunk(shape), _form(shape)
            except ValueError:  # said when the space is stepped
                pass

    def reread(self, space: pymunk.Space, shapes: Iterable[pymunk.Shape]) -> None:
        """Of these shapes, those whose geometry has been changed."""
        for shape in shapes:
            if shape.space is not space:  # a removed shape's number is another's
                continue
            self._added.pop(shape._hashid, None)
            known = self._store.shapes.get(shape._hashid) is shape
            if known and self._store.forms[shape._hashid] != _form(shape):
                self.refresh(space, shape)

    def refresh(self, space: pymunk.Space, shape: pymunk.Shape) -> None:
        """Read a shape's geometry again: `AreaContact.refresh`.

        Raises ValueError for a shape that is not entered, or that has no area now.
        """
        if not isinstance(shape, pymunk.Shape) or self.shapes.get(shape._hashid) is not shape:
            raise ValueError(f"shape must be one that the space has stepped with, got {shape!r:.80}")
        store = self._store.draft()
        store.forget([shape._hashid], ())
        self._take(store, shape)
        facts = self._hear(store, space)
        store.settle()
        self._store.publish(store, **facts)

    def largest(self) -> float:
        """The largest side (length) of the bounding boxes of the shapes that move; 1 if there are none."""
        boxes = [shape.bb for shape in self.shapes.values() if _moves(shape)]
        return max((max(bb.right - bb.left, bb.top - bb.bottom) for bb in boxes), default=1.0)

    def _take(self, store: Store, shape: pymunk.Shape) -> None:
        """Enter a shape into the tables."""
        outline, form = self._added.get(shape._hashid) or (Outline.from_pymunk(shape), _form(shape))
        body = shape.body
        assert body is not None
        left, bottom, right, top = outline.bounds
        store.shape(
            shape._hashid,
            address_of(shape._shape),
            outline,
            outline.mirror,
            address_of(body._body),
            shape.sensor,
            outline.smallest_extent,
            (0.5 * (right - left), 0.5 * (top - bottom)),
        )
        store.shapes[shape._hashid] = shape
        store.forms[shape._hashid] = form

    def _hear(self, store: Store, space: pymunk.Space) -> dict[str, int]:
        """Which shapes' collision types have callbacks of the user's, that may say no; facts by which it is known
        whether there are others.
        """
        everywhere = space._handlers.get((None, None))
        to_all = everywhere is not None and any(
            getattr(everywhere, phase) is not None
            for phase in ("begin", "pre_solve", "post_solve", "separate")
        )
        keys = [key for key in space._handlers if key != (None, None)]
        alone = {a for a, b in keys if b is None}
        pairs = {kind for a, b in keys if b is not None for kind in (a, b)}
        for ident, shape in store.shapes.items():
            kind = shape.collision_type
            row = store.tables.shapes[store.slots[ident]]
            row["type"], row["heard"] = kind, (to_all or kind in alone) + 2 * (kind in pairs)
        entries = ffi.cast("unsigned int **", address_of(space._space) + int(self._state["space_handlers"]))
        return {"handler_count": int(entries[0][0]), **self._hook.callbacks()}


def _form(shape: pymunk.Shape) -> Any:
    """What of a shape's geometry can be changed by pymunk's unsafe functions."""
    if isinstance(shape, pymunk.Circle):
        return shape.radius, shape.offset
    if isinstance(shape, pymunk.Segment):
        return shape.radius, shape.a, shape.b
    return shape.radius, shape.get_vertices() if isinstance(shape, pymunk.Poly) else None


def _moves(shape: pymunk.Shape) -> bool:
    return shape.body is not None and shape.body.body_type == pymunk.Body.DYNAMIC and not shape.sensor
