"""Runner that calls commands in this process."""

from typing import Any

from typer.testing import CliRunner

from geomtorsion.cli.app import app


def run(*arguments: str, code: int = 0, given: str = "") -> Any:
    """Result of `geomtorsion ARGUMENTS`, which must end with the given code.

    given: the text on standard input.
    """
    result = CliRunner().invoke(app, list(arguments), input=given)
    if result.exit_code != code:
        # The original exception is chained, so that the report shows its origin.
        raise AssertionError(
            f"ended with {result.exit_code}: {result.output}"
        ) from result.exception
    return result
