"""What one question needs to know of the store itself, each read once: words, rooms, thresholds."""

from __future__ import annotations

from dataclasses import dataclass

from d3a.colours import HISTOGRAM_SIZE, Palette
from d3a.parameters import DEFAULT, PROFILES, Parameters
from d3a.store.base import Region, Store, TaughtName


@dataclass(slots=True)
class Facts:
    """A view of the store for the length of one question; a later one sees later writes.

    Every method raises StoreError.
    """

    store: Store
    _categories: list[str] | None = None
    _classes: list[str] | None = None
    _names: list[TaughtName] | None = None
    _regions: list[Region] | None = None
    _palette: Palette | None = None

    def categories(self) -> list[str]:
        """Return the categories of the store, by name."""
        if self._categories is None:
            self._categories = [category for category, _ in self.store.categories()]
        return self._categories

    def classes(self) -> list[str] | None:
        """Return what the detectors that filled the store can recognise, None where unknown."""
        if self._classes is None:
            known = self.store.meta("classes")
            self._classes = [str(word) for word in known] if isinstance(known, list) else []
        return self._classes or None

    def names(self) -> list[TaughtName]:
        """Return what people call the objects."""
        if self._names is None:
            self._names = self.store.names()
        return self._names

    def regions(self) -> list[Region]:
        """Return the named rooms."""
        if self._regions is None:
            self._regions = self.store.regions()
        return self._regions

    def palette(self) -> Palette:
        """Return what the boxes of the whole store hold together, for colours."""
        if self._palette is None:
            _, matrix = self.store.embeddings()
            usable = matrix.shape[1:] == (HISTOGRAM_SIZE,)
            self._palette = Palette.of(matrix if usable else matrix[:0].reshape(0, HISTOGRAM_SIZE))
        return self._palette

    def parameters(self) -> Parameters:
        """Return the parameters that filled the store; unknown fields of a later version are left.

        A store that was filled with another `together_m` is asked with the same.
        """
        known = self.store.meta("parameters")
        if not isinstance(known, dict):
            return DEFAULT
        base = PROFILES.get(str(known.get("profile")), DEFAULT)
        fields = base.to_json().keys()
        return base.with_changes(**{name: known[name] for name in fields if name in known})
