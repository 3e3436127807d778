"""An attached space's class: its own, so that its contact hears of it, and copies of it take their contact along."""

from __future__ import annotations

from typing import Any

import pymunk

from ..debug_draw import true_outlines
from ..geometry.svg_picture import figure
from .contact_report import picture_of

#: Where a space keeps its contact: they go together, and pymunk does not pickle it.
KEY = "_area_contact"
_classes: dict[Any, type] = {}


def attached_class(plain: Any) -> type:
    """The class of attached spaces of the class `plain`: the same name, made once."""
    if plain not in _classes:

        def reduce(self: Any, protocol: Any) -> Any:
            contact = self.__dict__[KEY]
            self.__class__ = plain
            try:
                made = self.__reduce_ex__(protocol)
            finally:
                self.__class__ = _classes[plain]
            return _copy, (made, contact)

        def step(self: Any, dt: float) -> None:
            self.__dict__[KEY]._flexed(dt, lambda: plain.step(self, dt))

        def reindex_static(self: Any) -> None:
            plain.reindex_static(self)
            bodies = ((shape, shape.body) for shape in self._shapes)
            still = [shape for shape, body in bodies if body and body.body_type == pymunk.Body.STATIC]
            self.__dict__[KEY]._register.reread(still)

        def reindex_shape(self: Any, shape: pymunk.Shape) -> None:
            plain.reindex_shape(self, shape)
            self.__dict__[KEY]._register.reread([shape])

        def reindex_shapes_for_body(self: Any, body: pymunk.Body) -> None:
            plain.reindex_shapes_for_body(self, body)
            self.__dict__[KEY]._register.reread(body.shapes)

        def _add_shape(self: Any, shape: pymunk.Shape) -> None:
            plain._add_shape(self, shape)
            self.__dict__[KEY]._register.shape_came(shape)

        def _remove_shape(self: Any, shape: pymunk.Shape) -> None:
            register, ident = self.__dict__[KEY]._register, shape._hashid
            plain._remove_shape(self, shape)
            register.look_again() if self._locked else register.shape_went(shape, ident)

        def _add_body(self: Any, body: pymunk.Body) -> None:
            plain._add_body(self, body)
            self.__dict__[KEY]._register.body_came(body)

        def _remove_body(self: Any, body: pymunk.Body) -> None:
            register = self.__dict__[KEY]._register
            if body in self._bodies:
                register.look_again() if self._locked else register.body_goes(body)
            plain._remove_body(self, body)

        def debug_draw(self: Any, options: pymunk.SpaceDebugDrawOptions) -> None:
            with true_outlines(options):
                plain.debug_draw(self, options)

        def _repr_svg_(self: Any) -> str:
            return picture_of(self)

        def _repr_html_(self: Any) -> str:
            return figure(picture_of(self), repr(self.__dict__[KEY]))

        own: dict[str, Any] = {"_repr_svg_": _repr_svg_, "_repr_html_": _repr_html_}
        own |= {"__reduce_ex__": reduce, "__doc__": plain.__doc__}
        own |= {method.__name__: method for method in (_add_shape, _remove_shape, _add_body, _remove_body)}
        for method in (step, debug_draw, reindex_static, reindex_shape, reindex_shapes_for_body):
            method.__doc__ = getattr(plain, method.__name__).__doc__
            own[method.__name__] = method
        _classes[plain] = type(plain.__name__, (plain,), own)
        _classes[plain].__module__, _classes[plain].__qualname__ = plain.__module__, plain.__qualname__
    return _classes[plain]


def _copy(made: tuple[Any, ...], contact: Any) -> pymunk.Space:
    build, arguments, state = made[:3]
    space = build(*arguments)
    space.__setstate__(state)
    made_anew = space.__dict__.get(KEY)
    if (
        made_anew is not None
    ):  # the class attaches when it is made, or restored: the copy goes on as its original
        made_anew.detach()
    contact._install(space)
    return space
