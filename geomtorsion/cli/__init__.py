"""cli: what a person types."""

from geomtorsion.cli.guard import run


def main() -> None:
    """Entry point of the command ``geomtorsion``."""
    run()


__all__ = ["main"]
