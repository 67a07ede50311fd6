"""page: the notebook that marimo serves; each cell calls functions that are tested elsewhere."""

import marimo

app = marimo.App(
    width="medium", app_title="Torsion lab", css_file="lab.css", html_head_file="head.html"
)


@app.cell
def _():
    import marimo as mo

    from geomtorsion.lab import controls, views
    from geomtorsion.lab.tasks import common_runner

    runner = common_runner()
    mo.Html(views.header())
    return controls, mo, runner, views


@app.cell
def _(controls, mo):
    tab = controls.tabs(mo)
    mo.vstack([tab])
    return (tab,)


# -- any tetrad ---------------------------------------------------------------------------------


@app.cell
def _(controls, mo):
    beginning = controls.starts(mo)
    shown = controls.offered(mo)
    return beginning, shown


@app.cell
def _(beginning, controls, runner, mo):
    _chosen = beginning.value
    tetrad_facts = (
        controls.blank(_chosen)
        if isinstance(_chosen, int)
        else runner.ask("space_info", space=_chosen)
    )
    names = controls.names(mo, tetrad_facts)
    entries = controls.entries(mo, tetrad_facts)
    size = len(tetrad_facts["coordinates"])
    return entries, names, size


@app.cell
def _(controls, runner, entries, mo, names, shown, size, tab, views):
    mo.stop(tab.value != views.TETRAD)
    tetrad_reply = runner.ask(
        "tetrad",
        **names.value,
        entries=controls.rows(entries.value, size),
        show=[name for name, wanted in shown.value.items() if wanted],
    )
    return (tetrad_reply,)


@app.cell
def _(beginning, entries, mo, names, shown, size, tab, tetrad_reply, views):
    mo.stop(tab.value != views.TETRAD)
    _cells = [
        f"{entries[f'{i},{k}']}{views.fault(tetrad_reply, i, k)}"
        for i in range(size)
        for k in range(size)
    ]
    mo.vstack(
        [
            mo.Html(views.controls([beginning, *names.values()])),
            mo.Html(views.wrapped(views.grid(_cells, size))),
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
def _(controls, mo):
    loop_space = controls.spaces(mo)
    radius = controls.radius(mo)
    return loop_space, radius


@app.cell
def _(controls, runner, loop_space, mo):
    _facts = runner.ask("space_info", space=loop_space.value)
    centre = controls.centre(mo, _facts)
    plane = controls.plane(mo, _facts)
    return centre, plane


@app.cell
def _(centre, loop_space, mo, plane, radius, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.controls([loop_space, plane, radius, *centre.values()]))
    return


@app.cell
def _(centre, controls, loop_space, plane, radius):
    loop_case = controls.loop_case(loop_space.value, centre.value, radius.value, plane.value)
    return (loop_case,)


@app.cell
def _(runner, loop_case, mo, tab, views):
    mo.stop(tab.value != views.LOOPS)
    mo.Html(views.loop(runner.ask("loop", **loop_case)))
    return


# -- straightest and shortest -------------------------------------------------------------------


@app.cell
def _(controls, mo):
    path_space = controls.spaces(mo, "r3xso3")
    return (path_space,)


@app.cell
def _(controls, runner, mo, path_space):
    velocity = controls.velocity(mo, runner.ask("space_info", space=path_space.value))
    moments = controls.moments(mo, path_space.value)
    return moments, velocity


@app.cell
def _(mo, moments, path_space, tab, velocity, views):
    mo.stop(tab.value != views.PATHS)
    mo.Html(views.controls([path_space, *velocity.values(), *moments.values()]))
    return


@app.cell
def _(controls, moments, path_space, velocity):
    path_case = controls.path_case(path_space.value, velocity.value, moments.value)
    return (path_case,)


@app.cell
def _(runner, mo, path_case, tab, views):
    mo.stop(tab.value != views.PATHS)
    mo.Html(views.paths(runner.ask("paths", **path_case)))
    return


# -- the top ------------------------------------------------------------------------------------


@app.cell
def _(controls, mo):
    body = controls.body(mo)
    switches = controls.switches(mo)
    watched = controls.watched(mo)
    return body, switches, watched


@app.cell
def _(body, mo, switches, tab, views, watched):
    mo.stop(tab.value != views.TOP)
    mo.Html(views.controls([*body.values(), *switches.values(), watched]))
    return


@app.cell
def _(body, controls, switches, watched):
    top_case = controls.top_case(body.value, switches.value, watched.value)
    return (top_case,)


@app.cell
def _(runner, mo, tab, top_case, views):
    mo.stop(tab.value != views.TOP)
    mo.Html(views.top(runner.ask("top", **top_case)))
    return


# -- what accuracy costs ------------------------------------------------------------------------


@app.cell
def _(controls, mo):
    kind = controls.case_kind(mo)
    return (kind,)


@app.cell
def _(kind, mo, tab, views):
    mo.stop(tab.value != views.COSTS)
    mo.Html(views.controls([kind]))
    return


@app.cell
def _(runner, kind, loop_case, mo, path_case, tab, top_case, views):
    mo.stop(tab.value != views.COSTS)
    _case = {"loop": loop_case, "top": top_case}.get(kind.value, path_case)
    mo.Html(views.costs(runner.ask("costs", kind=kind.value, case=_case)))
    return


# -- exercises ----------------------------------------------------------------------------------


@app.cell
def _(controls, mo, runner):
    exercise = controls.exercises(mo, runner.ask("listing"))
    seed = controls.seed(mo)
    return exercise, seed


@app.cell
def _(controls, exercise, mo, runner, seed):
    stated = runner.ask("exercise", number=exercise.value, seed=int(seed.value or 0))
    form = controls.answers(mo, stated)
    hint = controls.next_hint(mo, stated)
    return form, hint, stated


@app.cell
def _(exercise, form, mo, seed, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES)
    mo.vstack(
        [
            mo.Html(views.controls([exercise, seed])),
            mo.Html(views.exercise(stated)),
            form,
        ]
    )
    return


@app.cell
def _(controls, form, mo, runner, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES)
    _reply = None
    if form.value is not None:
        _reply = runner.ask(
            "answer",
            number=stated["number"],
            seed=stated["seed"],
            answers=controls.given(stated, form.value),
        )
    mo.Html(views.verdict(_reply))
    return


@app.cell
def _(runner, hint, mo, stated, tab, views):
    mo.stop(tab.value != views.EXERCISES or "number" not in stated)
    _taken = runner.ask("hints", number=stated["number"], seed=stated["seed"], count=hint.value)
    mo.vstack([hint, mo.Html(views.steps(_taken))])
    return


if __name__ == "__main__":
    app.run()
