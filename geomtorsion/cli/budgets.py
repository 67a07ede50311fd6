"""budgets: the effects that an accuracy calls for, as files."""

from __future__ import annotations

import json
from pathlib import Path

from geomtorsion.pictures.style import can_draw, save
from geomtorsion.prices import EffectBudget
from geomtorsion.support.files import write_text


def write_budget(budget: EffectBudget, folder: Path, form: str) -> list[Path]:
    """Write effects.json and, with matplotlib, its figure."""
    paths = [folder / "effects.json"]
    write_text(paths[0], json.dumps(budget.to_json(), indent=2, ensure_ascii=False) + "\n")
    if can_draw():
        paths.append(folder / f"effects.{form}")
        save(budget.plot(), paths[1])
    return paths
