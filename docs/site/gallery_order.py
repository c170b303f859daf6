"""The order of the gallery."""

from sphinx_gallery.sorting import _SortKey


class Listed(_SortKey):
    ORDER = ("first_map", "inspection", "signed_distance", "moving_bodies", "hausdorff", "fitting", "sequence")

    def __call__(self, name):
        return self.ORDER.index(name.removesuffix(".py"))
