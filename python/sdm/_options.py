import inspect
from typing import Callable, TypeVar

from . import _core

Function = TypeVar("Function", bound=Callable[..., object])


def takes_options(call: str) -> Callable[[Function], Function]:
    """Gives a function that ends with ``**options`` the keywords of a call, which the library declares, in its signature and
    in place of {options} in its documentation. The stub beside its module has them for type checkers (python/stub.py)."""

    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)
        own = [parameter for parameter in signature.parameters.values() if parameter.kind is not parameter.VAR_KEYWORD]
        declared = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
            for name, annotation, default in _core.options(call)
        ]
        own.sort(key=lambda parameter: parameter.kind)
        first = sum(parameter.kind is not parameter.KEYWORD_ONLY for parameter in own)
        function.__signature__ = signature.replace(parameters=[*own[:first], *declared, *own[first:]])  # type: ignore[attr-defined]
        documentation = _core.option_documentation(call).replace("\n", "\n    ")
        function.__doc__ = (function.__doc__ or "").replace("{options}", documentation)
        return function

    return decorate
