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
        # An option that the function has itself is its own form of it.
        names = [parameter.name for parameter in own]
        declared = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
            for name, annotation, default in _core.options(call)
            if name not in names
        ]
        own.sort(key=lambda parameter: parameter.kind)
        first = sum(parameter.kind is not parameter.KEYWORD_ONLY for parameter in own)
        function.__signature__ = signature.replace(parameters=[*own[:first], *declared, *own[first:]])  # type: ignore[attr-defined]
        indent = "\n" + (function.__doc__ or "").partition("{options}")[0].rpartition("\n")[2]
        documentation = _core.option_documentation(call, names).replace("\n", indent)
        function.__doc__ = (function.__doc__ or "").replace("{options}", documentation)
        return function

    return decorate
