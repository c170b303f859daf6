"""Writes the stub of a module of the package, in which functions that take declared options have them as keywords.

python stub.py MODULE.py MODULE.pyi, where _core can be imported.
"""

import ast
import sys
from pathlib import Path

import _core


def call_of(function: ast.FunctionDef) -> "str | None":
    """What takes_options() is given."""
    for decorator in function.decorator_list:
        if isinstance(decorator, ast.Call) and isinstance(decorator.func, ast.Name) and decorator.func.id == "takes_options":
            (call,) = decorator.args
            return ast.literal_eval(call)
    return None


def with_options(function: ast.FunctionDef, call: str) -> None:
    arguments = function.args
    own = [argument.arg for argument in [*arguments.args, *arguments.kwonlyargs]]
    declared = ast.parse(f"def f(*, {_core.option_signature(call, own)}): ...").body[0].args
    arguments.kwarg = None
    arguments.kwonlyargs = declared.kwonlyargs + arguments.kwonlyargs
    arguments.kw_defaults = declared.kw_defaults + arguments.kw_defaults
    function.decorator_list = []


def main(source: Path, stub: Path) -> None:
    module = ast.parse(source.read_text())
    module.body = [node for node in module.body if not (isinstance(node, ast.ImportFrom) and node.module == "__future__")]
    classes = [node for node in module.body if isinstance(node, ast.ClassDef)]
    for node in [*module.body, *(member for one in classes for member in one.body)]:
        if isinstance(node, ast.FunctionDef):
            if call := call_of(node):
                with_options(node, call)
            node.body = [ast.Expr(ast.Constant(...))]
    stub.write_text(f"import collections.abc\nimport typing\n{ast.unparse(module)}\n")


main(Path(sys.argv[1]), Path(sys.argv[2]))
