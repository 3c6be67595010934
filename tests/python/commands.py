"""nevh tests: the commands as functions of the package nevh, and their tables.

    commands.py SRCDIR

SPDX-License-Identifier: GPL-3.0-or-later
"""

import doctest
import inspect
import json
import os
import pickle
import re
import shlex
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import nevh  # noqa: E402
from nevh import _classroom, _commands  # noqa: E402

sources, built = os.path.abspath(sys.argv[1]), os.getcwd()


def raised(kind, text, function, *arguments, **named):
    try:
        function(*arguments, **named)
    except kind as error:
        assert text in str(error), "%r is not in %r" % (text, str(error))
        return
    raise AssertionError("%s was not raised" % kind.__name__)


def test_all_commands_are_functions():
    listed = json.loads(subprocess.run([nevh.command(), "help", "--format", "json"],
                                       stdout=subprocess.PIPE).stdout.decode())
    for of in listed["commands"]:
        if of["name"] in ("help", "sweep"):
            continue
        function = getattr(nevh, of["name"]) if of["name"] != "gradients" else \
            _commands._function("gradients")
        parameters = inspect.signature(function).parameters
        here = [{"with": "with_effects", "without": "without_effects", "set": "parameters",
                 "start": "y0", "from": "from_scene", "for": "name",
                 "as": "form"}.get(name, name.replace("-", "_"))
                for name in of["options"]]
        left = set(here) - set(parameters) - {"format", "quiet", "help", "version"}
        assert left <= ({"output", "resume"} if "format" in of["options"] else set()), left
        assert of["name"] in dir(nevh)


def test_examples_of_the_docstrings():
    """Each docstring has a call, which works; two that are long are made shorter."""
    shorter = {"cost": ("t_end=20", "t_end=2, budget=0.1"),
               "hard": ("integrators", "'Kepler e = 0.9', integrators")}
    count = 0
    nevh.sheet(1, name="Ada", key=7, answers=True).to_csv("answers.csv")
    kits = [os.path.join(folder, "web/kit.html") for folder in (built, sources)]
    for name in [*_commands._names(), "sweep"]:
        if name == "page" and not any(map(os.path.exists, kits)):
            print("there is no web/kit.html: nevh.page is not tried")
            continue
        function = getattr(nevh, name)
        for test in doctest.DocTestFinder().find(function, name, globs={"nevh": nevh}):
            assert test.examples, name
            long, short = shorter.get(name, ("", ""))
            assert long in test.examples[0].source
            test.examples[0].source = test.examples[0].source.replace(long, short)
            runner = doctest.DocTestRunner()
            runner.run(test)
            assert not runner.failures, name
            count += 1
    assert count >= 20, count


def test_sheets_and_marks():
    assert len(nevh.sheet()) == 9 and nevh.sheet()["answers"][0] == 6
    made = nevh.sheet(1, name="Ada Lovelace", key=7, output="class")
    assert [os.path.basename(row["file"]) for row in made] == [
        "sheet-1-ada-lovelace.html", "sheet-1-ada-lovelace.ipynb"]
    assert all(map(os.path.exists, made["file"]))
    answers = nevh.sheet(1, name="Ada Lovelace", key=7, answers=True)
    assert (answers["lowest"] < answers["answer"]).all()
    answers[0]["answer"] *= 1.7
    answers.to_csv("answers.csv")
    marks = nevh.mark("answers.csv", key=7)
    assert marks["verdict"][0] != "right" and set(marks["verdict"][1:]) == {"right"}
    assert [word.lower() for word in marks.words] == ["ada lovelace: 5 of 6 are right"]
    page = nevh.sheet(1, name="Ada Lovelace", key=7, output="class.html")
    assert page["file"] == ["class.html"] and os.path.exists("class.html")
    raised(nevh.Refused, "there is no sheet 77", nevh.sheet, 77)
    raised(nevh.Refused, "No such file", nevh.mark, "no.csv")


def test_tables():
    table = nevh.compare("pendulum", ["verlet", "rk4"], dt=0.1, t_end=20,
                         parameters={"g": 1.6}, y0={"phi": 1})
    assert list(table["dt"]) == [0.1, 0.1] and table[1]["integrator"] == "rk4"
    assert table.columns == list(table[0]) and table.words
    raised(KeyError, "there is no column", lambda: table["dtt"])
    again = pickle.loads(pickle.dumps(table))
    assert again == table and again.words == table.words and again.columns == table.columns
    same = nevh.compare(nevh.Scene("pendulum", {"g": 1.6}), "verlet", 0.1, 20, y0=[1, 0])
    other = nevh.compare(nevh.Scene("pendulum").with_(g=1.7), "verlet", 0.1, 20, y0=[1, 0])
    assert same[0]["max_energy_error"] == table[0]["max_energy_error"] != other[0][
        "max_energy_error"]
    table.to_csv("a.csv")
    with open("a.csv") as file:
        assert file.readline().strip() == ",".join(table.columns)
    assert "same in all rows" in str(table) and "same in all rows" in table._repr_html_()
    part = nevh.compare("pendulum", ["verlet", "rk4"], dt=[0.1, 0.05], t_end=5)[1:3]
    assert isinstance(part, nevh.Table) and len(part["dt"]) == 2 and part.notes


def test_scenes_of_effects():
    scene = nevh.Scene(effects={"kinetic": "p_x^2/(2*m)", "spring": "k*x^2/2"},
                       parameters={"m": 1, "k": 4})
    one = nevh.solve(scene, (0, 5), [1, 0], "verlet", dt=0.1)
    two = nevh.solve("p_x^2/2 + 2*x^2", (0, 5), [1, 0], "verlet", dt=0.1)
    assert abs(one.y[0][-1] - two.y[0][-1]) < 1e-12
    off = nevh.Scene(effects={"kinetic": "p_x^2/2", "spring": "x^2/2"},
                     without_effects="spring")
    assert abs(nevh.solve(off, (0, 5), [1, 1], "verlet", dt=0.1).y[0][-1] - 6) < 1e-12
    assert "spring = k*x^2/2" in str(scene)
    assert nevh.Scene(str(scene)).names == ["x", "p_x"]
    shared = nevh.Scene(effects={"T": "p_x^2/2", "V": "s^2/2"}, definitions={"s": "sin(x)"})
    assert nevh.compare(shared, "verlet", 0.1, 10, y0=[1, 0])[0]["status"] == "ok"
    raised(TypeError, "one of the two", nevh.Scene)
    raised(TypeError, "one of the two", nevh.Scene, "pendulum", effects={})
    raised(nevh.Refused, "without #", nevh.Scene, effects={"T": "p_x^2/2 # half"})


def test_data_as_columns():
    orbit = nevh.solve("pendulum", (0, 4), {"phi": 1}, "gauss6", dt=0.1,
                       parameters={"g": 9.7})
    columns = {"t": list(orbit.t), "phi": list(orbit.y[0])}
    fitted = nevh.fit("pendulum", "gauss6", 0.1, data=columns, vary="g", y0={"phi": 1})
    assert abs(fitted[0]["value"] - 9.7) < 1e-6
    raised(nevh.Refused, "one length", nevh.fit, "pendulum", vary="g",
           data={"t": [0, 1], "phi": [0]})
    for data in ({"t": [0, 1], "phi": ["a", 0]}, {"t": [0, 1], "phi": 1}, {}, [[0, 1]]):
        raised(nevh.Refused, "data", nevh.fit, "pendulum", "gauss6", 0.1, data=data, vary="g")
    orbit = nevh.run("pendulum", "gauss6", 0.1, t_end=3)
    again = nevh.fit("pendulum", "gauss6", 0.1, data=orbit, vary="g",
                     parameters={"g": 9.7})
    assert abs(again[0]["value"] - 9.81) < 0.02, again


def test_formulas_need_a_step():
    """Before a function is traced, and so at once."""
    def H(t, y):
        called.append(t)
        return y[1]**2/2 + y[0]**2
    called = []
    for name, given in (("compare", {}), ("run", {}), ("chaos", {}), ("recommend", {
            "energy_error": 1e-6}), ("flow", {"shape": "disc(q = 1, p_q = 0, 0.1)"})):
        for source in (H, "p^2/2 - cos(q)"):
            raised(nevh.Refused, "needs dt", getattr(nevh, name), source, y0=[1, 0], t_end=5,
                   **given)
    raised(nevh.Refused, "a function needs y0 and t_end and dt", nevh.compare, H)
    assert not called


def test_wrong_calls():
    for kind, text, function, arguments, named in (
            (TypeError, "did you mean dt?", nevh.compare, ["pendulum"], {"dtt": 1}),
            (TypeError, "scene", nevh.compare, [], {}),
            (nevh.Refused, "did you mean verlet", nevh.flow, ["pendulum", "verlat"], {}),
            (nevh.Refused, "t_end", nevh.chaos, ["pendulum"], {"t_end": "banana"}),
            (nevh.Refused, "t_end", nevh.cost, ["p_x^2/2"], {"y0": [0, 1]}),
            (nevh.Refused, "data=FILE", nevh.fit, ["pendulum"], {"vary": "g"}),
            (TypeError, "portable", nevh.check, ["pendulum"], {"portable": "yes"}),
            (TypeError, "match", nevh.compare, ["pendulum"], {"match": object()}),
            (TypeError, "options", nevh.compare, ["pendulum"], {"options": "--portable"}),
            (nevh.Refused, "no_such", nevh.export, ["no_such.nevh"], {}),
            (nevh.Refused, "nan", nevh.compare, ["pendulum"], {"dt": float("nan")}),
            (TypeError, "scene is", nevh.report, [3], {})):
        raised(kind, text, function, *arguments, **named)
    raised(AttributeError, "did you mean compare?", getattr, nevh, "comparee")


def test_types():
    """The stub is that which stub.py makes of the package as it is."""
    made = subprocess.run([sys.executable, os.path.join(sources, "python/stub.py")],
                          stdout=subprocess.PIPE, encoding="utf-8", check=True).stdout
    with open(os.path.join(sources, "python/nevh/__init__.pyi"), encoding="utf-8") as file:
        assert file.read() == made, "run python/stub.py"
    made = subprocess.run(["awk", "-f", os.path.join(sources, "python/looks.awk"),
                           os.path.join(sources, "tools/plot/looks.h")],
                          capture_output=True, text=True, check=True).stdout
    with open(os.path.join(sources, "python/nevh/_looks.py"), encoding="utf-8") as file:
        assert file.read() == made, "run awk -f python/looks.awk"


def options_of(words):
    """{(option, value)} of words, numbers as numbers, --set a=1,b=2 as two."""
    found, words = set(), iter(words)
    for word in words:
        if word == "--":
            break
        name = {"-o": "output"}.get(word, word.lstrip("-"))
        if not word.startswith("-"):
            continue
        text = "" if _commands._list()[1][name]["argument"] is None else next(words)
        if name in ("format", "quiet", "output", "keep-plot-script"):
            continue
        for part in re.split(r",(?=\s*\w+\s*=)" if name in ("set", "start") else "\n", text):
            found.add((name, re.sub(
                r"(?<![\w.])\d[\d.]*(?:e-?\d+)?(?!\w)",
                lambda number: repr(float(number.group())), part.replace(" ", ""))))
    return found


def test_worksheets():
    """The notebooks are those that sheets.py makes, and their calls run the commands of
    the sheets."""
    sys.path.insert(0, os.path.join(sources, "python"))
    import sheets
    texi = os.path.join(sources, "doc/sheets/sheets.texi")
    sheets.main(texi, "sheets")
    for k in range(1, 10):
        name = "sheets/sheet-%d.ipynb" % k
        with open(os.path.join(sources, "python", name), encoding="utf-8") as kept:
            with open(name, encoding="utf-8") as made:
                assert kept.read() == made.read(), "run python/sheets.py"
    text = "".join(sheet.body for sheet in _classroom.read_sheets(texi))
    examples = re.findall(r"^@example\n(nevh .*?)\n@end example", text, re.S | re.M)
    lines = re.sub(r"\\\n\s*", "", "\n".join(examples)).splitlines()
    tried = 0
    for words in (shlex.split(line)[1:] for line in lines):
        call = _commands.call_of(words, *_commands._list(), _commands._here)
        compile(call, "call", "eval")
        if words[0] in ("sweep", "new") or ".nevh" in words[1]:
            continue
        recorded = []

        class Recorder:
            def __getattr__(self, name):
                return lambda *given, **named: recorded.append((given, named))
        eval(call, {"nevh": Recorder()})
        of = _commands._list()[0][words[0]]
        (given, named), = recorded
        bound = _commands._signature(of).bind(*given, **named)
        with tempfile.TemporaryDirectory() as folder:
            made, names = _commands._words(of, dict(bound.arguments), folder)
        assert names == [words[1]]
        assert options_of(made) == options_of(words[2:]), (made, words)
        tried += 1
    assert tried > 30, tried


def test_pictures():
    try:
        import matplotlib
    except ImportError:
        return
    matplotlib.use("Agg")
    table = nevh.compare("pendulum", ["verlet", "rk4"], dt=[0.1, 0.05], t_end=10)
    axes = table.plot()
    assert len(axes.lines) == 2 and axes.get_xscale() == "log"
    assert axes.lines[0].get_color() != axes.lines[1].get_color()
    assert nevh.solve("kepler", (0, 5), method="verlet", dt=0.1).plot().get_xlabel() == "x"
    ensemble = nevh.solve("kepler", (0, 5), [[1, 2], [0, 0], [0, 0], [1, 1]], "verlet", dt=0.1)
    for x, y in ((None, None), ("t", "x")):
        lines = ensemble.plot(x, y).lines
        assert [len(line.get_xdata()) for line in lines] == [len(ensemble.t)] * 2
        assert lines[1].get_ydata()[-1] == ensemble.y[0 if x else 1, 1, -1]
    raised(nevh.Refused, "give x and y", nevh.reference("pendulum", at=1).plot)
    raised(KeyError, "no column", table.plot, "dt", "err")


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = os.path.abspath(os.environ.get("PYTHONPATH", "."))
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, test in sorted(globals().items()):
            if name.startswith("test_"):
                test()
                print("passed", name)
        os.chdir(sources)
