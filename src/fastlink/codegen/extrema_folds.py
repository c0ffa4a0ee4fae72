"""The parts of a kernel of a search that look beside folds and toggles, where slopes may be rounding."""

from __future__ import annotations

from fastlink.codegen.extrema_places import PlacesWriter
from fastlink.codegen.runtime import cells, ends, hidden, noise, octaves, roots, splits, toggles
from fastlink.codegen.runtime.cells import LANES

__all__ = ["FoldsWriter"]


class FoldsWriter(PlacesWriter):
    """One kernel while it is written: beside folds."""

    @property
    def flagged(self) -> bool:
        """Whether lists of extremes have error bounds, which tell where a list is undecided."""
        return bool(self.kept) and self.program.has_bounds

    def write_value(self, number: int) -> None:
        """Write the quantity's evaluation at items of a search."""
        self.text.call(roots.every_vector, "vectors, filled", "n_open")
        self.text.add(f"value_{number}(state, vectors, n_open)")

    def write_splits(self, number: int) -> None:
        """Write the function on both sides of the places at which its cells are split."""
        text, last = self.text, f"int(splits[{splits.NEXT}, 0])"
        with text.block(f"for start in range({LANES}, {last}, {LANES}):"):
            text.call(cells.gather, f"splits, start, {last}, w, rows_{number}, state", "filled")
            text.call(roots.every_vector, "vectors, filled", "n_open")
            with text.block("for k in range(2):"):
                text.call(splits.place_split, "state, filled, k")
                text.add(f"slope_{number}(state, vectors, n_open)")
                text.call(splits.keep_slopes, f"state, filled, k, splits, start, split_by_{number}")

    def write_toggles(self, number: int, part: str) -> None:
        """Write the function beside toggles at which it vanishes, whose sign counts there."""
        text = self.text
        text.call(toggles.collect_toggles, f"w, table, {part}, samples, n_here, ends", "n_ends")
        with text.block(f"for start in range(0, n_ends, {LANES}):"):
            text.call(cells.gather, f"ends, start, n_ends, w, rows_{number}, state", "filled")
            text.call(roots.every_vector, "vectors, filled", "n_open")
            text.call(ends.place_ends, f"state, filled, {toggles.AWAY}")
            text.add(f"slope_{number}(state, vectors, n_open)")
            text.call(toggles.settle_toggles, "state, filled, samples")

    def looks_away(self, number: int) -> bool:
        """Whether the sampled function's signs beside toggles stand for those at toggles."""
        search = self.program.searches[number]
        return (search.divided or not search.parity) and search.order == 0

    def bounds_hidden(self, number: int) -> bool:
        """Whether what is then not looked for is in error bounds."""
        return bool(self.program.searches[number].bounded_by) and self.looks_away(number)

    def write_hidden(self, number: int) -> None:
        """Write which ends of the range have an extreme beside them that is not looked for."""
        text = self.text
        text.call(roots.every_vector, "vectors, filled", "n_open")
        text.call(toggles.place_near, "state, filled, w, table, 1.0")
        text.add(f"slope_{number}(state, vectors, n_open)")
        text.call(toggles.keep_near, "state, filled")
        text.call(toggles.place_near, f"state, filled, w, table, {toggles.AWAY}")
        text.add(f"slope_{number}(state, vectors, n_open)")
        text.call(toggles.count_turned, "state, filled, w, table", "n_turned")
        with text.block("if n_turned > 0:"):
            text.call(toggles.place_near, f"state, filled, w, table, {toggles.BEYOND * toggles.AWAY}")
            self.write_value(number)
            text.call(toggles.keep_away, "state, filled")
            text.call(toggles.place_near, "state, filled, w, table, 1.0")
            self.write_value(number)
            text.call(toggles.keep_turned, "state, filled")

    def write_octaves(self, number: int, part: str) -> None:
        """Write the samples of cells next to a fold, where the function is small or far greater between."""
        text, search = self.text, self.program.searches[number]
        text.call(octaves.collect_folds, f"w, table, {part}, samples, n_here, ends", "n_ends")
        with text.block(f"for start in range(0, n_ends, {LANES}):"):
            text.call(cells.gather, f"ends, start, n_ends, w, rows_{number}, state", "filled")
            text.call(roots.every_vector, "vectors, filled", "n_open")
            text.call(octaves.begin_octaves, "state, filled")
            with text.block(f"for k in range({octaves.FEW}):"):
                text.call(
                    octaves.place_octave, f"state, filled, {octaves.COARSE} * k + {octaves.COARSE // 2}, 0"
                )
                text.add(f"slope_{number}(state, vectors, n_open)")
                text.call(octaves.weigh_octave, "state, filled")
            with text.block(f"for trial in range({octaves.TRIALS + 1}):"):
                text.call(octaves.to_sample, "state, filled, trial, octaves", "n_octaves")
                with text.block("for k in range(n_octaves):"):
                    text.call(octaves.place_octave, "state, filled, k, trial")
                    text.add(f"slope_{number}(state, vectors, n_open)")
                    text.call(octaves.keep_octave, "state, filled, k, trial, octaves")
            text.call(octaves.collect_octaves, "state, filled, octaves, counts, roots, splits")
            text.call(octaves.replace_cells, "state, filled, marks")
            # by its symmetry the slope of one with a parity is 0 at the fold: it falls, and hides nothing
            if self.flagged and search.bounded_by and not (search.onto or search.parity):
                self.write_certainty(number)

    def write_certainty(self, number: int) -> None:
        """Write how far towards the fold the slope is certain, and that the lists of those that fall are marked."""
        text = self.text
        text.call(hidden.begin_certain, "state, filled")
        with text.block(f"for k in range({octaves.OCTAVES}):"):
            text.call(octaves.place_octave, "state, filled, k, 0")
            self.write_value(number)
            text.call(hidden.keep_certain, "state, filled")
        text.call(hidden.note_hidden, f"state, filled, table, search_{number}, best")

    def write_noise(self, number: int) -> None:
        """Write the quantity's evaluation beside items that are next to a fold."""
        text = self.text
        text.call(noise.count_folded, "state, filled, w, table", "n_near")
        with text.block("if n_near > 0:"):
            text.call(roots.every_vector, "vectors, filled", "n_open")
            with text.block(f"for k in range({noise.SLOPES}):"):
                text.call(noise.place_slope, "state, filled, k")
                text.add(f"slope_{number}(state, vectors, n_open)")
                text.call(noise.keep_slope, "state, filled, k")
            text.call(noise.settle_slopes, "state, filled")
            with text.block(f"for trial in range({noise.TRIALS}):"):
                text.call(noise.place_beside_fold, "state, filled, trial")
                self.write_value(number)
                text.call(noise.keep_beside_fold, "state, filled")

    def write_thinning(self) -> None:
        """Write that lists of extremes leave out what is rounding."""
        columns = len(self.program.branches) * LANES
        for number, search in enumerate(self.program.searches):
            if not search.onto:
                first = number * columns
                self.text.call(noise.thin, f"lists, best, {first}, {first + columns}, {self.room(search)}")

    def write_flags(self) -> None:
        """Write that lists that doubles do not decide tell so by their bounds."""
        columns = len(self.program.branches) * LANES
        for number, search in enumerate(self.program.searches):
            if not search.onto:
                first = number * columns
                self.text.call(
                    hidden.flag_undecided, f"lists, best, {first}, {first + columns}, {self.room(search)}"
                )
