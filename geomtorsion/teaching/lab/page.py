"""page: the notebook that marimo serves; each cell calls functions that are tested elsewhere."""

# /// script
# [tool.marimo.display]
# theme = "system"
# ///
import marimo

app = marimo.App(
    width="medium", app_title="Torsion lab", css_file="lab.css", html_head_file="head.html"
)


@app.cell
def _():
    # A cell sees variables of other cells, but no imports at the top of the file.
    import marimo as mo

    # Also imported here for this reason.
    from geomtorsion.teaching.lab import anew, controls, exercise_controls, tetrad_controls, views
    from geomtorsion.teaching.lab.kept import Kept, keep
    from geomtorsion.teaching.lab.tasks import common_runner

    runner = common_runner()
    # Content of the address when the page was opened.
    kept = Kept.now(mo)
    mo.Html(views.header())
    return Kept, anew, controls, exercise_controls, keep, kept, mo, runner, tetrad_controls, views


@app.cell
def _(controls, kept, mo):
    tab = controls.tabs(mo, kept)
    mo.vstack([tab])
    return (tab,)


@app.cell
def _(keep, mo, tab, views):
    keep(mo, {"tab": (tab.value, views.COMPASS)})
    return


# -- the compass --------------------------------------------------------------------------------


@app.cell
def _(controls, kept, mo):
    course = controls.course(mo, kept)
    return (course,)


@app.cell
def _(course, mo, tab, views):
    mo.stop(tab.value != views.COMPASS)
    mo.Html(views.controls([course], "after"))
    return


@app.cell
def _(controls, course, keep, mo, runner, tab, views):
    mo.stop(tab.value != views.COMPASS)
    keep(mo, {"course": (f"{course.value:g}", f"{controls.PAGE.course:g}")})
    mo.Html(views.compass(runner.ask("compass", course=course.value)))
    return


# -- any tetrad ---------------------------------------------------------------------------------


@app.cell
def _(kept, mo, tetrad_controls):
    beginning = tetrad_controls.starts(mo, kept)
    shown = tetrad_controls.offered(mo, kept)
    return beginning, shown


@app.cell
def _(Kept, anew, beginning, mo, runner, tetrad_controls):
    tetrad_facts = tetrad_controls.facts(beginning.value, runner)
    _own = Kept.now(mo).of_case("start", beginning.value, tetrad_controls.first_start())
    anew.numbers_apart(mo, list(beginning.options.values()), beginning.value, 4)
    names = tetrad_controls.names(mo, tetrad_facts, _own)
    # Current entries: the fields are created again when coordinates are renamed.
    typed = tetrad_controls.typed(tetrad_facts, _own)
    return names, tetrad_facts, typed


@app.cell
def _(anew, beginning, mo, names, tetrad_controls, typed):
    columns = tetrad_controls.coordinates(names.value)
    anew.numbers_apart(mo, list(beginning.options.values()), beginning.value, tetrad_controls.MOST)
    entries = tetrad_controls.entries(mo, columns, typed)
    return columns, entries


@app.cell
def _(
    beginning,
    columns,
    entries,
    keep,
    mo,
    names,
    runner,
    shown,
    tab,
    tetrad_controls,
    tetrad_facts,
    typed,
    views,
):
    mo.stop(tab.value != views.TETRAD)
    typed.update(entries.value)
    _rows = tetrad_controls.rows(entries.value, len(columns))
    _show = [name for name, wanted in shown.value.items() if wanted]
    tetrad_reply = runner.ask("tetrad", **tetrad_controls.tetrad_case(names.value, _rows, _show))
    keep(mo, tetrad_controls.kept_tetrad(beginning.value, tetrad_facts, names.value, _rows, _show))
    return (tetrad_reply,)


@app.cell
def _(anew, beginning, columns, entries, mo, names, shown, tab, tetrad_reply, views):
    mo.stop(tab.value != views.TETRAD)
    _size = len(columns)
    _cells = [
        f"{entries[f'{i},{k}']}{views.fault(tetrad_reply, i, k)}"
        for i in range(_size)
        for k in range(_size)
    ]
    mo.vstack(
        [
            mo.Html(views.controls([beginning])),
            mo.Html(anew.drawn_anew(views.controls(names.values()), beginning.value)),
            mo.Html(
                anew.drawn_anew(views.wrapped(views.grid(_cells, _size)), beginning.value, _size)
            ),
            mo.accordion({"What to show": mo.Html(views.controls(list(shown.values())))}),
        ]
    )
    return


@app.cell
def _(mo, tab, tetrad_reply, views):
    mo.stop(tab.value != views.TETRAD)
    mo.Html(views.tetrad(tetrad_reply))
    return


# -- loops --------------------------------------------------------------------------------------


@app.cell
def _(controls, kept, mo):
    loop_space = controls.spaces(mo, controls.FIRST_LOOP, kept, "loop")
    radius = controls.radius(mo, kept)
    return loop_space, radius


@app.cell
def _(Kept, controls, loop_space, mo, runner):
    loop_facts = runner.ask("space_info", space=loop_space.value)
    _own = Kept.now(mo).of_case("loop", loop_space.value, controls.FIRST_LOOP)
    centre = controls.centre(mo, loop_facts, _own)
    plane = controls.plane(mo, loop_facts, _own)
    return centre, loop_facts, plane


@app.cell
def _(centre, loop_space, mo, plane, radius, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.controls([loop_space, plane, radius, *centre.values()], "after"))
    return


@app.cell
def _(centre, controls, loop_space, plane, radius):
    loop_case = controls.loop_case(loop_space.value, centre.value, radius.value, plane.value)
    return (loop_case,)


@app.cell
def _(centre, controls, keep, loop_case, loop_facts, mo, plane, radius, runner, tab, views):
    mo.stop(tab.value != views.LOOPS)
    keep(mo, controls.kept_loop(loop_facts, centre.value, radius.value, plane.value))
    loop_reply = runner.ask("loop", **loop_case)
    mo.Html(views.loop(loop_reply))
    return (loop_reply,)


@app.cell
def _(loop_reply, mo, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.loop_below(loop_reply))
    return


@app.cell
def _(mo, runner, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.atoms(runner.ask("atoms")))
    return


# -- loops in a map that is given ---------------------------------------------------------------


@app.cell
def _(controls, mo):
    given = controls.upload(mo)
    map_measure = controls.map_measure(mo)
    return given, map_measure


@app.cell
def _(given, mo, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.map_field(given))
    return


@app.cell
def _(given, mo, runner):
    # Only the worker reads the file.
    mo.stop(not given.value)
    map_file = given.value[0]
    map_facts = runner.ask("map_facts", map_file.contents, name=map_file.name)
    return map_facts, map_file


@app.cell
def _(controls, map_facts, mo):
    map_settings = controls.map_settings(mo, map_facts)
    return (map_settings,)


@app.cell
def _(controls, map_facts, map_measure, mo):
    # Settings of grains and symmetry do not move the circuit.
    map_places = controls.map_places(mo, map_facts, map_measure.value)
    return (map_places,)


@app.cell
def _(map_facts, map_file, map_measure, map_places, map_settings, mo, runner, tab, views):
    mo.stop(tab.value != views.LOOPS)
    map_said = map_facts
    if map_settings.value:
        _chosen = map_settings.value
        map_said = runner.ask("map_facts", map_file.contents, name=map_file.name, **_chosen)
    _controls = [*map_settings.values(), map_measure, *map_places.values()]
    mo.Html(
        views.map_told(map_said) + views.controls(_controls if map_places.value else [], "measured")
    )
    return (map_said,)


@app.cell
def _(
    controls,
    map_facts,
    map_file,
    map_measure,
    map_places,
    map_said,
    map_settings,
    mo,
    runner,
    tab,
    views,
):
    # A cell above has already reported why the file cannot be read with these settings.
    mo.stop(tab.value != views.LOOPS or not map_places.value or "problem" in map_said)
    _case = controls.map_case(map_facts, map_places.value, map_measure.value) | map_settings.value
    map_reply = runner.ask("map_circuit", map_file.contents, name=map_file.name, **_case)
    mo.Html(views.measured(map_reply))
    return


# -- straightest and shortest -------------------------------------------------------------------


@app.cell
def _(controls, kept, mo):
    path_space = controls.spaces(mo, controls.FIRST_PATH, kept, "path")
    return (path_space,)


@app.cell
def _(Kept, controls, mo, path_space, runner):
    path_facts = runner.ask("space_info", space=path_space.value)
    _own = Kept.now(mo).of_case("path", path_space.value, controls.FIRST_PATH)
    velocity = controls.velocity(mo, path_facts, _own)
    moments = controls.moments(mo, path_space.value, _own)
    return moments, path_facts, velocity


@app.cell
def _(mo, moments, path_space, tab, velocity, views):
    mo.stop(tab.value != views.PATHS)
    mo.Html(views.controls([path_space, *velocity.values(), *moments.values()], "after"))
    return


@app.cell
def _(controls, moments, path_space, velocity):
    path_case = controls.path_case(path_space.value, velocity.value, moments.value)
    return (path_case,)


@app.cell
def _(controls, keep, mo, moments, path_case, path_facts, runner, tab, velocity, views):
    mo.stop(tab.value != views.PATHS)
    keep(mo, controls.kept_path(path_facts, velocity.value, moments.value))
    path_reply = runner.ask("paths", **path_case)
    mo.Html(views.paths(path_reply))
    return (path_reply,)


@app.cell
def _(mo, path_reply, tab, views):
    mo.stop(tab.value != views.PATHS)
    mo.Html(views.paths_below(path_reply))
    return


# -- the top ------------------------------------------------------------------------------------


@app.cell
def _(controls, kept, mo):
    body = controls.body(mo, kept)
    switches = controls.switches(mo, kept)
    watched = controls.watched(mo, kept)
    return body, switches, watched


@app.cell
def _(body, mo, switches, tab, views, watched):
    mo.stop(tab.value != views.TOP)
    mo.Html(views.controls([watched, *switches.values(), *body.values()], "after"))
    return


@app.cell
def _(body, controls, switches, watched):
    top_case = controls.top_case(body.value, switches.value, watched.value)
    return (top_case,)


@app.cell
def _(body, controls, keep, mo, runner, switches, tab, top_case, views, watched):
    mo.stop(tab.value != views.TOP)
    keep(mo, controls.kept_top(body.value, switches.value, watched.value))
    top_reply = runner.ask("top", **top_case)
    mo.Html(views.top(top_reply))
    return (top_reply,)


@app.cell
def _(mo, tab, top_reply, views):
    mo.stop(tab.value != views.TOP)
    mo.Html(views.top_below(top_reply))
    return


# -- what accuracy costs ------------------------------------------------------------------------


@app.cell
def _(controls, kept, mo):
    kind = controls.case_kind(mo, kept)
    return (kind,)


@app.cell
def _(keep, kind, mo, tab, views):
    mo.stop(tab.value != views.COSTS)
    keep(mo, {"measure": (kind.value, "loop")})
    mo.Html(views.controls([kind]))
    return


@app.cell
def _(kind, loop_case, mo, path_case, runner, tab, top_case, views):
    mo.stop(tab.value != views.COSTS)
    _case = {"loop": loop_case, "top": top_case}.get(kind.value, path_case)
    mo.Html(views.costs(runner.ask("costs", kind=kind.value, case=_case)))
    return


# -- exercises ----------------------------------------------------------------------------------


@app.cell
def _(exercise_controls, kept, mo, runner):
    exercise = exercise_controls.exercises(mo, runner.ask("listing"), kept)
    seed = exercise_controls.seed(mo, kept)
    return exercise, seed


@app.cell
def _(Kept, exercise, exercise_controls, mo, runner, seed):
    _variant = exercise_controls.variant(seed.value)
    stated = runner.ask("exercise", number=exercise.value, seed=_variant)
    # Includes the text typed before the user switched to another exercise.
    fields = exercise_controls.answers(mo, stated, Kept.now(mo))
    check = mo.ui.run_button(label="Check")
    hint = exercise_controls.next_hint(mo, stated)
    sent, send = mo.state(None)
    return check, fields, hint, send, sent, stated


@app.cell
def _(check, exercise, fields, mo, seed, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES)
    mo.vstack(
        [
            mo.Html(views.controls([exercise, seed])),
            mo.Html(views.exercise(stated)),
            fields,
            check,
        ]
    )
    return


@app.cell
def _(exercise, exercise_controls, fields, keep, mo, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES)
    # Each input is saved at once, so that a reload loses nothing.
    _first = next(iter(exercise.options.values()))
    keep(mo, exercise_controls.kept_exercise(stated, _first, fields.value))
    return


@app.cell
def _(check, exercise_controls, fields, send, stated):
    if check.value and "number" in stated:
        send(exercise_controls.given(stated, fields.value))
    return


@app.cell
def _(mo, runner, sent, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES)
    _answers = sent()
    _reply = None
    if _answers is not None:
        _reply = runner.ask(
            "answer", number=stated["number"], seed=stated["seed"], answers=_answers
        )
    mo.Html(views.verdict(_reply))
    return


@app.cell
def _(hint, mo, runner, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES or "number" not in stated)
    _taken = runner.ask("hints", number=stated["number"], seed=stated["seed"], count=hint.value)
    mo.vstack([hint, mo.Html(views.steps(_taken))])
    return


if __name__ == "__main__":
    app.run()
