"""Types of nevh, made by python/stub.py."""

from os import PathLike
from typing import (Any, Callable, Dict, Iterable, List, Literal, Mapping, Sequence,
                    SupportsIndex, overload)

__version__: str
verdicts: tuple[str, ...]

class Error(Exception):
    result: Any

class Failed(Error, ArithmeticError):
    ...

class Refused(Error, ValueError):
    ...

class Result(Dict[str, Any]):
    def plot(self, x: str | None = None, y: Any = None, ax: Any = None) -> Any: ...
    def __getattr__(self, name: str) -> Any: ...

class Table(List[Dict[str, Any]]):
    def __init__(self, rows: Iterable[Dict[str, Any]] = (), notes: Iterable[str] = (),
        words: Iterable[str] = (), columns: Iterable[str] = (), command: Iterable[str] =
        ()) -> None: ...
    def to_pandas(self) -> Any: ...
    def to_csv(self, file: str | PathLike[str]) -> None: ...
    def plot(self, x: str | None = None, y: Any = None, by: str | None = None, ax: Any =
        None) -> Any: ...
    columns: List[str]
    notes: List[str]
    words: List[str]
    command: List[str]
    @overload
    def __getitem__(self, key: str) -> Any: ...
    @overload
    def __getitem__(self, key: SupportsIndex) -> Dict[str, Any]: ...
    @overload
    def __getitem__(self, key: slice) -> List[Dict[str, Any]]: ...

class Text(str):
    def save(self, file: str | PathLike[str]) -> None: ...

class HGrad:
    def __init__(self, H: Any, ds: float | Sequence[float] | None = None, *, gradient: str
        = 'central4', args: Sequence[Any] = (), coordinates: Sequence[str] | None = None,
        with_effects: str | Sequence[str] = (), without_effects: str | Sequence[str] = (),
        params: Any = None, parameters: Mapping[str, Any] | None = None, **constants:
        Any) -> None: ...
    def __call__(self, t: float, y: Any) -> Any: ...

class Integrator:
    def __init__(self, name: str = 'own', *, kick: Sequence[Any] | None = None, drift:
        Sequence[Any] | None = None, first: str = 'kick', a: Sequence[Sequence[Any]] |
        None = None, b: Sequence[Any] | None = None, c: Sequence[Any] | None = None,
        compose: Any = None, step: Callable[..., Any] | None = None) -> None: ...

class Scene:
    def __init__(self, source: str | PathLike[str] | Callable[..., float] | None = None,
        parameters: Mapping[str, Any] | None = None, coordinates: Sequence[str] | None =
        None, with_effects: str | Sequence[str] = (), without_effects: str | Sequence[str]
        = (), y0: Sequence[float] | None = None, *, effects: Mapping[str, str] | None =
        None, definitions: Mapping[str, str] | None = None) -> None: ...
    def with_(self, **parameters: Any) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def n(self) -> int: ...
    @property
    def names(self) -> List[str]: ...
    def start(self, y0: Any = None) -> Any: ...
    @property
    def text(self) -> str: ...
    path: Any
    is_formula: bool

def chaos(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, gradient: str |
        Sequence[str] | None = None, gradient_step: float | None = None, budget: float |
        None = None, samples: int | None = None, exponents: int | str | None = None,
        starts: int | None = None, gali: int | None = None, portable: bool | None = None,
        allow_code: bool | None = None, coordinates: Sequence[str] | None = None, options:
        Sequence[str] = ()) -> Table: ...
def check(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, gradient: str |
        Sequence[str] | None = None, gradient_step: float | None = None, portable: bool |
        None = None, allow_code: bool | None = None, all: bool | None = None, coordinates:
        Sequence[str] | None = None, options: Sequence[str] = ()) -> Table: ...
def command() -> str: ...
def compare(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, observable: float | str | None = None, repeat:
        int | None = None, transform: float | str | None = None, match: Literal["steps",
        "work"] | None = None, diagnostics: bool | None = None, portable: bool | None =
        None, native: Literal["auto", "always", "never"] | None = None, no_cache: bool |
        None = None, plot: str | PathLike[str] | None = None, plot_narrow: bool | None =
        None, plot_kind: Literal["phase", "time", "energy", "configuration", "animation",
        "order"] | None = None, keep_plot_script: str | PathLike[str] | None = None,
        allow_code: bool | None = None, coordinates: Sequence[str] | None = None, options:
        Sequence[str] = ()) -> Table: ...
def cost(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, gradient: str |
        Sequence[str] | None = None, gradient_step: float | None = None, by:
        Literal["energy", "state"] | None = None, against: Literal["work", "length"] |
        None = None, observable: float | str | None = None, repeat: int | None = None,
        budget: float | None = None, portable: bool | None = None, native: Literal["auto",
        "always", "never"] | None = None, no_cache: bool | None = None, plot: str |
        PathLike[str] | None = None, plot_narrow: bool | None = None, plot_kind:
        Literal["phase", "time", "energy", "configuration", "animation", "order"] | None =
        None, keep_plot_script: str | PathLike[str] | None = None, allow_code: bool | None
        = None, coordinates: Sequence[str] | None = None, options: Sequence[str] =
        ()) -> Table: ...
def effects(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, gradient: str |
        Sequence[str] | None = None, gradient_step: float | None = None, error: float |
        None = None, portable: bool | None = None, plot: str | PathLike[str] | None =
        None, plot_narrow: bool | None = None, keep_plot_script: str | PathLike[str] |
        None = None, allow_code: bool | None = None, impact: bool | None = None, needed:
        float | str | None = None, coordinates: Sequence[str] | None = None, options:
        Sequence[str] = ()) -> Table: ...
def export(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, every: int | None = None, portable: bool |
        None = None, header: bool | None = None, allow_code: bool | None = None, output:
        str | PathLike[str] | None = None, coordinates: Sequence[str] | None = None,
        options: Sequence[str] = ()) -> Text: ...
def fit(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, vary: Mapping[str, Any] | Sequence[str] | str
        | None = None, data: str | PathLike[str] | Mapping[str, Any] | None = None, sigma:
        float | None = None, portable: bool | None = None, columns: str | Sequence[str] |
        None = None, allow_code: bool | None = None, coordinates: Sequence[str] | None =
        None, options: Sequence[str] = ()) -> Table: ...
def flow(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, samples: int | None = None, at: float | str |
        Sequence[float | str] | None = None, shape: str | Sequence[str] | None = None,
        portable: bool | None = None, plot: str | PathLike[str] | None = None,
        plot_narrow: bool | None = None, keep_plot_script: str | PathLike[str] | None =
        None, allow_code: bool | None = None, coordinates: Sequence[str] | None = None,
        options: Sequence[str] = ()) -> Table: ...
def frequencies(scene: Any, integrators: str | Sequence[str] | None = None, dt: float |
        str | Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, observable: float | str | None = None,
        portable: bool | None = None, allow_code: bool | None = None, coordinates:
        Sequence[str] | None = None, options: Sequence[str] = ()) -> Table: ...
def gradients(scene: Any = None, *arguments: Any, **named: Any) -> Any: ...
def hard(case: str | None = None, integrators: str | Sequence[str] | None = None, *,
        gradient: str | Sequence[str] | None = None, all: bool | None = None, options:
        Sequence[str] = ()) -> Table: ...
def integrators() -> List[str]: ...
def library() -> str: ...
def list(what: str, *, all: bool | None = None, options: Sequence[str] = ()) -> Table: ...
def mark(file: str, *, name: str | PathLike[str] | None = None, key: str | Sequence[str] |
        None = None, options: Sequence[str] = ()) -> Table: ...
def new(file: str, *, with_effects: str | Sequence[str] | None = None, without_effects:
        str | Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None,
        from_scene: str | PathLike[str] | None = None, allow_code: bool | None = None,
        coordinates: Sequence[str] | None = None, options: Sequence[str] = ()) -> str: ...
def page(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, *, with_effects: str | Sequence[str] | None =
        None, without_effects: str | Sequence[str] | None = None, parameters: Mapping[str,
        Any] | None = None, y0: Mapping[str, float | str] | Sequence[float] | None = None,
        gradient: str | Sequence[str] | None = None, output: str | PathLike[str] | None =
        None, coordinates: Sequence[str] | None = None, options: Sequence[str] =
        ()) -> Text: ...
def portrait(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, vary: Mapping[str, Any] | Sequence[str] | str
        | None = None, data: str | PathLike[str] | Mapping[str, Any] | None = None,
        portable: bool | None = None, native: Literal["auto", "always", "never"] | None =
        None, no_cache: bool | None = None, plot: str | PathLike[str] | None = None,
        plot_narrow: bool | None = None, keep_plot_script: str | PathLike[str] | None =
        None, section: str | Sequence[str] | None = None, allow_code: bool | None = None,
        coordinates: Sequence[str] | None = None, options: Sequence[str] =
        ()) -> Text: ...
def recommend(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str
        | Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, gradient: str |
        Sequence[str] | None = None, gradient_step: float | None = None, energy_error:
        float | None = None, state_error: float | None = None, observable: float | str |
        None = None, error: float | None = None, repeat: int | None = None, portable: bool
        | None = None, native: Literal["auto", "always", "never"] | None = None, no_cache:
        bool | None = None, allow_code: bool | None = None, coordinates: Sequence[str] |
        None = None, options: Sequence[str] = ()) -> Table: ...
def reference(scene: Any, t_end: float | str | None = None, *, with_effects: str |
        Sequence[str] | None = None, without_effects: str | Sequence[str] | None = None,
        parameters: Mapping[str, Any] | None = None, y0: Mapping[str, float | str] |
        Sequence[float] | None = None, at: float | str | Sequence[float | str] | None =
        None, digits: int | None = None, stop_after: str | Sequence[str] | None = None,
        allow_code: bool | None = None, coordinates: Sequence[str] | None = None, options:
        Sequence[str] = ()) -> Table: ...
def report(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, variant:
        Mapping[str, Any] | Sequence[str] | str | None = None, y0: Mapping[str, float |
        str] | Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, portable: bool | None = None, allow_code: bool
        | None = None, all: bool | None = None, output: str | PathLike[str] | None = None,
        coordinates: Sequence[str] | None = None, options: Sequence[str] =
        ()) -> Text: ...
def run(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, every: int | None = None, samples: int | None
        = None, at: float | str | Sequence[float | str] | None = None, data: str |
        PathLike[str] | Mapping[str, Any] | None = None, transform: float | str | None =
        None, portable: bool | None = None, native: Literal["auto", "always", "never"] |
        None = None, no_cache: bool | None = None, plot: str | PathLike[str] | None =
        None, plot_narrow: bool | None = None, plot_kind: Literal["phase", "time",
        "energy", "configuration", "animation", "order"] | None = None, columns: str |
        Sequence[str] | None = None, keep_plot_script: str | PathLike[str] | None = None,
        allow_code: bool | None = None, coordinates: Sequence[str] | None = None, options:
        Sequence[str] = ()) -> Table: ...
def scenes() -> List[str]: ...
def section(scene: Any, integrators: str | Sequence[str] | None = None, dt: float | str |
        Sequence[float | str] | None = None, t_end: float | str | None = None, *,
        with_effects: str | Sequence[str] | None = None, without_effects: str |
        Sequence[str] | None = None, parameters: Mapping[str, Any] | None = None, y0:
        Mapping[str, float | str] | Sequence[float] | None = None, tolerance: float |
        Sequence[float] | None = None, gradient: str | Sequence[str] | None = None,
        gradient_step: float | None = None, vary: Mapping[str, Any] | Sequence[str] | str
        | None = None, transform: float | str | None = None, portable: bool | None = None,
        native: Literal["auto", "always", "never"] | None = None, no_cache: bool | None =
        None, plot: str | PathLike[str] | None = None, plot_narrow: bool | None = None,
        keep_plot_script: str | PathLike[str] | None = None, section: str | Sequence[str]
        | None = None, after: float | str | None = None, allow_code: bool | None = None,
        coordinates: Sequence[str] | None = None, options: Sequence[str] =
        ()) -> Table: ...
def sheet(number: int | str | None = None, *, name: str | PathLike[str] | None = None,
        key: str | Sequence[str] | None = None, answers: bool | None = None, form:
        Literal["page", "notebook", "check", "moodle", "form"] | None = None, output: str
        | PathLike[str] | None = None, options: Sequence[str] = ()) -> Table: ...
def solve(H: Any, t_span: Sequence[float] | None = None, y0: Sequence[float] |
        Mapping[str, float | str] | None = None, method: str | type | None = None, *, dt:
        float | None = None, rtol: float | None = None, atol: float | Sequence[float] |
        None = None, t_eval: Sequence[float] | None = None, gradient: str | None = None,
        gradient_step: float | Sequence[float] | None = None, parameters: Mapping[str,
        Any] | None = None, args: Sequence[Any] = (), coordinates: Sequence[str] | None =
        None, with_effects: str | Sequence[str] = (), without_effects: str | Sequence[str]
        = (), params: Any = None, observe: Callable[[float, Any], Any] | None = None,
        every: int = 1, events: Any = None, dense_output: bool = False, max_step: float |
        None = None, check: bool = True) -> Result: ...
def sweep(scene: str | PathLike[str] | Scene, vary: Any = None, outcomes: str |
        Sequence[str] | None = None, integrator: str | None = None, *, dt: float | None =
        None, t_end: float | None = None, rtol: float | None = None, gradient: str | None
        = None, threads: int | None = None, count: int | None = None, seed: int | None =
        None, combine: str | None = None, y0: Sequence[float] | Mapping[str, float | str]
        | None = None, parameters: Mapping[str, Any] | None = None, coordinates:
        Sequence[str] | None = None, with_effects: str | Sequence[str] = (),
        without_effects: str | Sequence[str] = ()) -> Any: ...
