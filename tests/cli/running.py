"""Commands called in this process, as most tests of the command line do."""

from typing import Any

from typer.testing import CliRunner

from geomtorsion.cli.app import app


def run(*arguments: str, code: int = 0, given: str = "") -> Any:
    """The result of `geomtorsion ARGUMENTS`, which has to end with a code.

    given: what stands on standard input.
    """
    result = CliRunner().invoke(app, list(arguments), input=given)
    if result.exit_code != code:
        # The exception goes along, so that the report shows where it arose.
        raise AssertionError(
            f"ended with {result.exit_code}: {result.output}"
        ) from result.exception
    return result
