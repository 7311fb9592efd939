"""PyTorch: a simulation as a layer of a larger program.

Simulations compute in double precision, and a design of `torch.float32` is refused, since rounding it would spoil what
follows: write `x.double()`, as for the output of a network in single precision. Gradients arrive in the type of what
`double()` was called for.

Designs may be batches (…, n_x): they are simulated one after the other. Layers have first derivatives only,
by `backward` and `torch.autograd`; the transforms of `torch.func` (`grad`, `vmap`, …) are not supported. They run on
the processor; results are on the device of x.

A failed simulation raises `SimulationError`. With `failures="nan"` values and gradients of such a design are NaN
instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

try:
    import torch  # type: ignore[import-not-found,import-untyped,unused-ignore]
except ImportError as error:
    raise ImportError("flexbody.torch needs PyTorch: pip install torch") from error

from ._layers import Functions, Histories

if TYPE_CHECKING:
    from .problem import Problem

__all__ = ["function", "histories"]


def function(
    problem: Problem, functions: Sequence[str] | None = None, *, failures: str = "raise"
) -> Callable[[Any], Any]:
    """A function x → values (…, n_f) of the `functions` of a problem (default all), in the units of the file.

    x is a tensor (…, n_x) of `torch.float64`, or a mapping from the names of all variables to tensors (…). Gradients
    are exact.
    """
    layer = Functions(problem, functions, failures)

    def differentiable(x: Any) -> Any:
        return _Values.apply(_design(problem, x), layer)

    return differentiable


def histories(
    problem: Problem,
    names: Sequence[str],
    at: ArrayLike | None = None,
    *,
    fractions: ArrayLike | None = None,
    failures: str = "raise",
) -> Callable[[Any], Any]:
    """A function x → histories (…, n_names, n_t) of the quantities behind functions of a problem.

    The instants (n_t,) are `at` [s], fixed whatever the design, or `fractions` of the duration of each design's motion,
    with which they move; default those of the file, which move alike. The name `"time"` stands for the instants
    themselves, unless a function has that name. A design whose motion ends before the last of `at` is a `ValueError`,
    or NaN with `failures="nan"`.

    x is as for `function`. Gradients are exact: one adjoint march for a weight of all histories of a design.
    """
    layer = Histories(problem, names, at, fractions, failures)

    def differentiable(x: Any) -> Any:
        return _Histories.apply(_design(problem, x), layer)

    return differentiable


class _Values(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """Values with the gradients that `forward` found."""

    @staticmethod
    def forward(ctx: Any, x: Any, layer: Functions) -> Any:
        ctx.save_for_backward(x)
        designs = _rows(x)
        if ctx.needs_input_grad[0]:
            found = [layer.both(row) for row in designs]
            ctx.slopes = torch.as_tensor(_stack([slopes for _, slopes in found], len(layer.names), layer.inputs))
            values = [value for value, _ in found]
        else:
            values = [layer.values(row) for row in designs]
        stacked = torch.as_tensor(_stack(values, len(layer.names)), device=x.device)
        return stacked.reshape(*x.shape[:-1], len(layer.names))

    @staticmethod
    def backward(ctx: Any, weights: Any) -> Any:
        slopes = ctx.slopes.to(weights.device)
        flat = weights.detach().reshape(-1, slopes.shape[1])
        pulled = torch.einsum("bf,bfx->bx", flat, slopes)
        return _Once.apply(pulled.reshape(*weights.shape[:-1], slopes.shape[2]), *ctx.saved_tensors, weights), None


class _Histories(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """Histories, pulled back by the adjoint."""

    @staticmethod
    def forward(ctx: Any, x: Any, layer: Histories) -> Any:
        ctx.save_for_backward(x)
        found = [layer.run(row) for row in _rows(x)]
        ctx.layer, ctx.responses = layer, [response for _, response in found]
        values = _stack([value for value, _ in found], len(layer.names), layer.instants)
        return torch.as_tensor(values, device=x.device).reshape(*x.shape[:-1], len(layer.names), layer.instants)

    @staticmethod
    def backward(ctx: Any, weights: Any) -> Any:
        layer = ctx.layer
        flat = weights.detach().cpu().numpy().reshape(-1, len(layer.names), layer.instants)
        pulled = [layer.pull_back(response, row) for response, row in zip(ctx.responses, flat, strict=True)]
        found = torch.as_tensor(_stack(pulled, layer.inputs), device=weights.device)
        return _Once.apply(found.reshape(*weights.shape[:-2], layer.inputs), *ctx.saved_tensors, weights), None


class _Once(torch.autograd.Function):  # type: ignore[misc,unused-ignore]
    """A gradient that refuses to be differentiated, rather than to count as constant."""

    @staticmethod
    def forward(ctx: Any, gradient: Any, x: Any, weights: Any) -> Any:
        return gradient.clone()

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        raise NotImplementedError("flexbody.torch: simulations have first derivatives only")


def _rows(x: Any) -> Any:
    """Designs (B, n_x) of a tensor (…, n_x)."""
    return x.detach().cpu().numpy().reshape(-1, x.shape[-1])


def _stack(arrays: list[Any], *shape: int) -> Any:
    return np.stack(arrays) if arrays else np.empty((0, *shape))


def _design(problem: Problem, x: Any) -> Any:
    """x as a tensor (…, n_x) in double precision."""
    names = list(problem.variables.names)
    if isinstance(x, Mapping):
        if set(x) != set(names):
            raise ValueError(f"x: expected the variables {', '.join(names)}, found {', '.join(map(str, x))}")
        x = torch.stack([x[name] for name in names], dim=-1)
    if not isinstance(x, torch.Tensor):
        raise TypeError(f"x: expected a tensor of torch.float64, found {type(x).__name__}")
    if x.dtype != torch.float64:
        raise TypeError(f"x: expected torch.float64, found {x.dtype}; write x.double()")
    if x.ndim == 0 or x.shape[-1] != len(names):
        raise ValueError(f"x: expected shape (…, {len(names)}), found shape {tuple(x.shape)}")
    return x
