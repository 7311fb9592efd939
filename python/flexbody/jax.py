"""JAX: a simulation as a function that JAX differentiates.

JAX must compute in double precision; `float32` is refused, since it would spoil the derivatives:

    jax.config.update("jax_enable_x64", True)

Functions run on the host, alone, under `jax.jit` (by `jax.pure_callback`), and under `jax.vmap` one after the other.
They have first derivatives only.

A failed simulation raises `SimulationError`; under `jax.jit` JAX raises an error of its own with the same text. With
`failures="nan"` values and derivatives of such a design are NaN instead.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

try:
    import jax  # type: ignore[import-not-found,import-untyped,unused-ignore]
    import jax.numpy as jnp  # type: ignore[import-not-found,import-untyped,unused-ignore]
except ImportError as error:
    raise ImportError("flexbody.jax needs JAX: pip install jax") from error

from ._layers import Functions, Histories

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["function", "histories"]

_KEPT = 8
"""Motions that are kept for their derivatives. Those of earlier designs are simulated again."""


def function(
    problem: Problem, functions: Sequence[str] | None = None, *, failures: str = "raise"
) -> Callable[[Any], Any]:
    """A function x → values (n_f,) of the `functions` of a problem (default all), in the units of the file.

    x is an array (n_x,) of `float64` or a mapping from the names of all variables to numbers. Derivatives are exact,
    forward (`jax.jvp`, `jax.jacfwd`) and in reverse (`jax.grad`, `jax.vjp`, `jax.jacrev`).
    """
    layer = Functions(problem, functions, failures)
    n, m = layer.inputs, len(layer.names)
    values_shape = jax.ShapeDtypeStruct((m,), np.float64)
    slopes_shape = jax.ShapeDtypeStruct((m, n), np.float64)

    @jax.custom_jvp
    def values(x: Any) -> Any:
        return _hosted(layer.values, values_shape, x)

    @jax.custom_jvp
    def both(x: Any) -> Any:
        return _hosted(layer.both, (values_shape, slopes_shape), x)

    @values.defjvp  # type: ignore[untyped-decorator,unused-ignore]
    def _(primals: Any, tangents: Any) -> Any:
        found, slopes = both(*primals)
        return found, slopes @ tangents[0]

    @both.defjvp  # type: ignore[untyped-decorator,unused-ignore]
    def _(primals: Any, tangents: Any) -> Any:
        raise NotImplementedError("flexbody.jax: simulations have first derivatives only")

    def differentiable(x: Any) -> Any:
        return values(_design(problem, x))

    return differentiable


def histories(
    problem: Problem,
    names: Sequence[str],
    at: ArrayLike | None = None,
    *,
    fractions: ArrayLike | None = None,
    failures: str = "raise",
) -> Callable[[Any], Any]:
    """A function x → histories (n_names, n_t) of the quantities behind functions of a problem.

    The instants (n_t,) are `at` [s], fixed whatever the design, or `fractions` of the duration of each design's motion,
    with which they move; default those of the file, which move alike. The name `"time"` stands for the instants
    themselves, unless a function has that name. A design whose motion ends before the last of `at` is a `ValueError`,
    or NaN with `failures="nan"`.

    x is as for `function`. Derivatives are exact and in reverse only (`jax.grad`, `jax.vjp`, `jax.jacrev`): one adjoint
    march for a weight of all histories.
    """
    layer = Histories(problem, names, at, fractions, failures)
    shape = jax.ShapeDtypeStruct((len(layer.names), layer.instants), np.float64)
    design_shape = jax.ShapeDtypeStruct((layer.inputs,), np.float64)
    known: OrderedDict[bytes, Any] = OrderedDict()

    def run(x: Any) -> Any:
        x = np.array(x, dtype=np.float64)
        found, known[x.tobytes()] = layer.run(x)
        while len(known) > _KEPT:
            known.popitem(last=False)
        return found

    def pull_back(x: Any, weights: Any) -> Any:
        x = np.array(x, dtype=np.float64)
        response = known[x.tobytes()] if x.tobytes() in known else layer.run(x)[1]
        return layer.pull_back(response, weights)

    @jax.custom_vjp
    def values(x: Any) -> Any:
        return _hosted(run, shape, x)

    @jax.custom_vjp
    def pulled(x: Any, weights: Any) -> Any:
        return _hosted(pull_back, design_shape, x, weights)

    def once(*_: Any) -> Any:
        raise NotImplementedError("flexbody.jax: simulations have first derivatives only")

    values.defvjp(lambda x: (values(x), x), lambda x, weights: (pulled(x, weights),))
    pulled.defvjp(once, once)

    def differentiable(x: Any) -> Any:
        return values(_design(problem, x))

    return differentiable


def _hosted(call: Callable[..., Any], shapes: Any, *arguments: Any) -> Any:
    """Calls a function of NumPy arrays: at once where JAX knows the arguments, so that its exceptions arrive as they
    are, else by a callback."""
    if any(isinstance(argument, jax.core.Tracer) for argument in arguments):
        return jax.pure_callback(call, shapes, *arguments, vmap_method="sequential")
    return jax.tree_util.tree_map(jnp.asarray, call(*arguments))


def _design(problem: Problem, x: Any) -> Any:
    """x as an array (n_x,) of JAX in double precision."""
    if not jax.config.jax_enable_x64:
        raise TypeError(
            "flexbody.jax: expected double precision; call "
            'jax.config.update("jax_enable_x64", True) before JAX computes'
        )
    names = list(problem.variables.names)
    if isinstance(x, Mapping):
        if set(x) != set(names):
            raise ValueError(f"x: expected the variables {', '.join(names)}, found {', '.join(map(str, x))}")
        x = jnp.stack([jnp.asarray(x[name]).reshape(()) for name in names])
    x = jnp.asarray(x)
    if x.dtype.kind in "iu":
        x = x.astype(np.float64)
    if x.dtype != np.float64:
        raise TypeError(f"x: expected float64, found {x.dtype}")
    if x.shape != (len(names),):
        raise ValueError(f"x: expected shape ({len(names)},), found shape {x.shape}")
    return x
