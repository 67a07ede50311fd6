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
    from geomtorsion.teaching.lab import controls, exercise_controls, guides, tetrad_controls, views
    from geomtorsion.teaching.lab import element_keys as keys
    from geomtorsion.teaching.lab.query import Query, store
    from geomtorsion.teaching.lab.tasks import common_runner
    from geomtorsion.teaching.texts import ENGLISH, languages

    runner = common_runner()
    # Content of the address when the page was opened.
    query = Query.now(mo)
    language = query.one_of("language", languages(), ENGLISH)
    mo.Html(views.header(language))
    return (
        Query,
        controls,
        exercise_controls,
        guides,
        keys,
        language,
        mo,
        query,
        runner,
        store,
        tetrad_controls,
        views,
    )


@app.cell
def _(controls, language, mo, query, views):
    tab = controls.tabs(mo, query, language)
    mo.vstack([tab, mo.Html(views.computing(language))])
    return (tab,)


@app.cell
def _(guides, language, tab):
    # The label of a tab depends on the language, its name does not.
    opened = guides.named(tab.value, language)
    return (opened,)


# -- controls of all tabs with pictures, and the cases that they describe -------------------------


@app.cell
def _(controls, language, mo, query):
    course = controls.course(mo, query, language)
    loop_space = controls.spaces(mo, controls.FIRST_LOOP, query, "loop", language)
    radius = controls.radius(mo, query, language)
    path_space = controls.spaces(mo, controls.FIRST_PATH, query, "path", language)
    top = controls.top(mo, query, language)
    kind = controls.case_kind(mo, query, language)
    return course, kind, loop_space, path_space, radius, top


@app.cell
def _(Query, controls, language, loop_space, mo, runner):
    loop_facts = runner.ask("space_info", space=loop_space.value)
    _own = Query.now(mo).of_case("loop", loop_space.value, controls.FIRST_LOOP)
    place = controls.place(mo, loop_facts, _own, language)
    return loop_facts, place


@app.cell
def _(Query, controls, language, mo, path_space, runner):
    path_facts = runner.ask("space_info", space=path_space.value)
    _own = Query.now(mo).of_case("path", path_space.value, controls.FIRST_PATH)
    curve = controls.curve(mo, path_facts, _own, language)
    return curve, path_facts


@app.cell
def _(
    course,
    curve,
    guides,
    kind,
    language,
    loop_space,
    mo,
    path_space,
    place,
    radius,
    store,
    opened,
    top,
    views,
):
    store(mo, {"tab": (opened, guides.COMPASS)})
    _panels = {
        guides.COMPASS: [course],
        guides.LOOPS: [loop_space, radius, *place.values()],
        guides.PATHS: [path_space, *curve.values()],
        guides.TOP: top.values(),
        guides.COSTS: [kind],
    }
    mo.stop(opened not in _panels)
    _shown = views.controls(_panels[opened], "after", language)
    mo.Html(views.of_tab(opened, _shown, result=False))
    return


@app.cell
def _(controls, curve, loop_facts, path_facts, place, radius, top):
    _path = controls.path_case(path_facts["name"], curve.value)
    cases = {
        "loop": controls.loop_case(loop_facts, place.value, radius.value),
        "straightest": _path,
        "shortest": _path,
        "top": controls.top_case(top.value),
    }
    return (cases,)


# -- the compass --------------------------------------------------------------------------------


@app.cell
def _(controls, course, guides, language, mo, opened, runner, store, views):
    mo.stop(opened != guides.COMPASS)
    store(mo, {"course": (f"{course.value:g}", f"{controls.PAGE.course:g}")})
    _reply = runner.ask("compass", course=course.value, language=language)
    mo.Html(views.of_tab(opened, views.compass(_reply, language)))
    return


# -- any tetrad ---------------------------------------------------------------------------------


@app.cell
def _(language, mo, query, tetrad_controls):
    beginning = tetrad_controls.starts(mo, query, language)
    shown = tetrad_controls.offered(mo, query, language)
    return beginning, shown


@app.cell
def _(Query, beginning, keys, language, mo, runner, tetrad_controls):
    tetrad_facts = tetrad_controls.facts(beginning.value, runner)
    _own = Query.now(mo).of_case("start", beginning.value, tetrad_controls.first_start())
    keys.skip_numbers(mo, list(beginning.options.values()), beginning.value, 4)
    names = tetrad_controls.names(mo, tetrad_facts, _own, language)
    # Current entries: the fields are created again when coordinates are renamed.
    typed = tetrad_controls.typed(tetrad_facts, _own)
    return names, tetrad_facts, typed


@app.cell
def _(beginning, keys, language, mo, names, tetrad_controls, typed):
    columns = tetrad_controls.coordinates(names.value)
    keys.skip_numbers(mo, list(beginning.options.values()), beginning.value, tetrad_controls.MOST)
    entries = tetrad_controls.entries(mo, columns, typed, language)
    return columns, entries


@app.cell
def _(
    beginning,
    columns,
    entries,
    guides,
    language,
    mo,
    names,
    runner,
    shown,
    store,
    opened,
    tetrad_controls,
    tetrad_facts,
    typed,
):
    mo.stop(opened != guides.TETRAD)
    typed.update(entries.value)
    _rows = tetrad_controls.rows(entries.value, len(columns))
    _show = [name for name, wanted in shown.value.items() if wanted]
    _case = tetrad_controls.tetrad_case(names.value, _rows, _show, language)
    tetrad_reply = runner.ask("tetrad", **_case)
    store(
        mo, tetrad_controls.tetrad_query(beginning.value, tetrad_facts, names.value, _rows, _show)
    )
    return (tetrad_reply,)


@app.cell
def _(
    beginning,
    columns,
    entries,
    guides,
    keys,
    language,
    mo,
    names,
    shown,
    opened,
    tetrad_controls,
    tetrad_reply,
    views,
):
    mo.stop(opened != guides.TETRAD)
    _size = len(columns)
    _cells = [
        f"{entries[f'{i},{k}']}{views.fault(tetrad_reply, i, k)}"
        for i in range(_size)
        for k in range(_size)
    ]
    mo.vstack(
        [
            mo.Html(views.of_tab(opened, views.controls([beginning]), result=False)),
            mo.Html(keys.keyed(views.controls(names.values()), beginning.value)),
            mo.Html(keys.keyed(views.wrapped(views.grid(_cells, _size)), beginning.value, _size)),
            mo.accordion(
                {
                    tetrad_controls.quantities(language): mo.Html(
                        views.controls(list(shown.values()))
                    )
                }
            ),
        ]
    )
    return


@app.cell
def _(guides, language, mo, opened, tetrad_reply, views):
    mo.stop(opened != guides.TETRAD)
    mo.Html(views.of_tab(opened, views.tetrad(tetrad_reply, language)))
    return


# -- loops --------------------------------------------------------------------------------------


@app.cell
def _(
    cases, controls, guides, language, loop_facts, mo, place, radius, runner, store, opened, views
):
    mo.stop(opened != guides.LOOPS)
    store(mo, controls.loop_query(loop_facts, place.value, radius.value))
    loop_reply = runner.ask("loop", **cases["loop"], language=language)
    mo.Html(views.of_tab(opened, views.loop(loop_reply, language)))
    return (loop_reply,)


@app.cell
def _(guides, language, loop_reply, mo, opened, views):
    mo.stop(opened != guides.LOOPS)
    mo.Html(views.of_tab(opened, views.loop_below(loop_reply, language), result=False))
    return


@app.cell
def _(guides, language, mo, opened, runner, views):
    mo.stop(opened != guides.LOOPS)
    _reply = runner.ask("atoms", language=language)
    mo.Html(views.of_tab(opened, views.atoms(_reply, language), result=False))
    return


# -- loops in an uploaded map or image -----------------------------------------------------------


@app.cell
def _(controls, language, mo):
    map_upload = controls.upload(mo, language)
    map_measure = controls.map_measure(mo, language)
    return map_upload, map_measure


@app.cell
def _(guides, language, map_upload, mo, opened, views):
    mo.stop(opened != guides.LOOPS)
    mo.Html(views.of_tab(opened, views.map_field(map_upload, language), result=False))
    return


@app.cell
def _(language, map_upload, mo, runner):
    # Only the worker reads the file.
    mo.stop(not map_upload.value)
    _file = map_upload.value[0]

    def ask_map(task, **options):
        return runner.ask(task, _file.contents, name=_file.name, language=language, **options)

    map_facts = ask_map("map_facts")
    return ask_map, map_facts


@app.cell
def _(controls, language, map_facts, mo):
    map_settings = controls.map_settings(mo, map_facts, language)
    return (map_settings,)


@app.cell
def _(controls, language, map_facts, map_measure, mo):
    # Settings of grains and symmetry do not move the circuit.
    map_places = controls.map_places(mo, map_facts, map_measure.value, language)
    return (map_places,)


@app.cell
def _(ask_map, guides, map_facts, map_measure, map_places, map_settings, mo, opened, views):
    mo.stop(opened != guides.LOOPS)
    map_state = map_facts
    if map_settings.value:
        map_state = ask_map("map_facts", **map_settings.value)
    _controls = [*map_settings.values(), map_measure, *map_places.values()]
    _shown = views.map_description(map_state)
    _shown += views.controls(_controls if map_places.value else [], "measured")
    mo.Html(views.of_tab(opened, _shown, result=False))
    return (map_state,)


@app.cell
def _(
    ask_map,
    controls,
    guides,
    language,
    map_facts,
    map_measure,
    map_places,
    map_settings,
    map_state,
    mo,
    opened,
    views,
):
    # A cell above has already reported why the file cannot be read with these settings.
    mo.stop(opened != guides.LOOPS or not map_places.value or "problem" in map_state)
    _case = controls.map_case(map_facts, map_places.value, map_measure.value) | map_settings.value
    map_reply = ask_map("map_circuit", **_case)
    mo.Html(views.of_tab(opened, views.map_circuit(map_reply, language), result=False))
    return


# -- straightest and shortest -------------------------------------------------------------------


@app.cell
def _(cases, controls, curve, guides, language, mo, path_facts, runner, store, opened, views):
    mo.stop(opened != guides.PATHS)
    store(mo, controls.path_query(path_facts, curve.value))
    path_reply = runner.ask("paths", **cases["straightest"], language=language)
    mo.Html(views.of_tab(opened, views.paths(path_reply, language)))
    return (path_reply,)


@app.cell
def _(guides, language, mo, opened, path_reply, views):
    mo.stop(opened != guides.PATHS)
    mo.Html(views.of_tab(opened, views.paths_below(path_reply, language), result=False))
    return


# -- the top ------------------------------------------------------------------------------------


@app.cell
def _(cases, controls, guides, language, mo, runner, store, opened, top, views):
    mo.stop(opened != guides.TOP)
    store(mo, controls.top_query(top.value))
    top_reply = runner.ask("top", **cases["top"], language=language)
    mo.Html(views.of_tab(opened, views.top(top_reply, language)))
    return (top_reply,)


@app.cell
def _(guides, language, mo, opened, top_reply, views):
    mo.stop(opened != guides.TOP)
    mo.Html(views.of_tab(opened, views.top_below(top_reply, language), result=False))
    return


# -- what accuracy costs ------------------------------------------------------------------------


@app.cell
def _(cases, guides, kind, language, mo, opened, runner, store, views):
    mo.stop(opened != guides.COSTS)
    store(mo, {"measure": (kind.value, "loop")})
    _reply = runner.ask("costs", kind=kind.value, case=cases[kind.value], language=language)
    mo.Html(views.of_tab(opened, views.costs(_reply, language)))
    return


# -- exercises ----------------------------------------------------------------------------------


@app.cell
def _(exercise_controls, language, mo, query, runner):
    # The texts of an exercise depend on both.
    texts_from = {"language": language, "chapter": exercise_controls.chapter(mo)}
    exercise = exercise_controls.exercises(mo, runner.ask("listing", **texts_from), query, language)
    seed = exercise_controls.seed(mo, query, language)
    return exercise, seed, texts_from


@app.cell
def _(Query, exercise, exercise_controls, language, mo, runner, seed, texts_from):
    _variant = exercise_controls.variant(seed.value)
    stated = runner.ask("exercise", number=exercise.value, seed=_variant, **texts_from)
    # Includes the text typed before the user switched to another exercise.
    fields = exercise_controls.answers(mo, stated, Query.now(mo), language)
    check = exercise_controls.check(mo, language)
    hint = exercise_controls.next_hint(mo, stated, language)
    sent, send = mo.state(None)
    return check, fields, hint, send, sent, stated


@app.cell
def _(check, exercise, fields, guides, language, mo, opened, seed, stated, views):
    mo.stop(opened != guides.EXERCISES)
    mo.vstack(
        [
            mo.Html(views.controls([exercise, seed])),
            mo.Html(views.of_tab(opened, views.exercise(stated, language))),
            fields,
            check,
        ]
    )
    return


@app.cell
def _(exercise, exercise_controls, fields, guides, mo, stated, store, opened):
    mo.stop(opened != guides.EXERCISES)
    # Each input is saved at once, so that a reload loses nothing.
    _first = next(iter(exercise.options.values()))
    store(mo, exercise_controls.exercise_query(stated, _first, fields.value))
    return


@app.cell
def _(check, exercise_controls, fields, send, stated):
    if check.value and "number" in stated:
        send(exercise_controls.given(stated, fields.value))
    return


@app.cell
def _(guides, language, mo, opened, runner, sent, stated, texts_from, views):
    mo.stop(opened != guides.EXERCISES)
    _answers = sent()
    _reply = None
    if _answers is not None:
        _reply = runner.ask(
            "answer",
            number=stated["number"],
            seed=stated["seed"],
            answers=_answers,
            **texts_from,
        )
    mo.Html(views.of_tab(opened, views.verdict(_reply, language), result=False))
    return


@app.cell
def _(guides, hint, language, mo, opened, runner, stated, texts_from, views):
    mo.stop(opened != guides.EXERCISES or "number" not in stated)
    _taken = runner.ask(
        "hints", number=stated["number"], seed=stated["seed"], count=hint.value, **texts_from
    )
    _steps = views.of_tab(opened, views.steps(_taken, language), result=False)
    mo.vstack([hint, mo.Html(_steps)])
    return


if __name__ == "__main__":
    app.run()
