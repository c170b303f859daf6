"""The pictures that programs of the gallery save as PNG files."""

import shutil
from pathlib import Path

from sphinx_gallery.scrapers import figure_rst


def scrape(block, block_vars, gallery_conf):
    """The pictures that a cell has saved, in reStructuredText."""
    images = []
    for path in sorted(Path(block_vars["src_file"]).parent.glob("*.png")):
        image = next(block_vars["image_path_iterator"])
        shutil.move(path, image)
        images.append(image)
    return figure_rst(images, gallery_conf["src_dir"])
