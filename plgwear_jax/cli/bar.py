"""The progress of a sweep, as a bar on standard error."""

from typing import Self

from rich.console import Console
from rich.progress import Progress

from plgwear_jax._core.words import one_line


class Bar(Progress):
    """A progress bar on standard error with the time left, shown if there is something to do."""

    def __init__(self, names: list[str]) -> None:
        super().__init__(console=Console(stderr=True))
        self.first: int | None = None
        self.done = self.points = 0
        self._names = one_line(", ".join(names))

    def __enter__(self) -> Self:
        return self  # not shown yet

    def __call__(self, done: int, points: int) -> None:
        """Show that this many of the points are done."""
        if self.first is None:
            self.first = done  # points of finished chunks do not count for the time left
            if done < points:
                self.add_task(self._names, total=points - done)
                self.start()
        self.done, self.points = done, points
        for task in self.task_ids:
            self.update(task, completed=done - self.first)

    def __exit__(self, *error: object) -> None:
        if self.tasks:
            self.stop()

    @property
    def share(self) -> str:
        """The share of the points that is done, as text."""
        return f"{100.0 * self.done / self.points if self.points else 0.0:.1f} %"

    def said(self, seconds: float) -> str:
        """A summary of what was computed in this time."""
        computed = self.done - (self.first or 0)
        if computed == 0:
            return "all were computed already"
        there = f", {self.first:,} were computed already" if self.first else ""
        return f"{computed:,} computed in {seconds:.3g} s, compiling included{there}"
