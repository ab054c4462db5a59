"""Configuration of Sphinx. `make docs` builds the documentation into build/docs.

The same sources give the same files: nothing here depends on the date, the machine or the network.
"""

import sys
from importlib.metadata import version as _version
from pathlib import Path

# For the extensions, and so that generated pages describe this checkout.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

project = "bodycheck"
author = "The bodycheck developers"
copyright = author  # without a year, which would change the pages
release = version = _version("bodycheck")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "docs.extensions.code_lines",
    "docs.extensions.generated",
    "docs.extensions.mathml",
    "docs.extensions.moved",
    "docs.extensions.notebooks",
    "docs.extensions.schemas",
    "docs.extensions.versions",
]
exclude_patterns = ["_build", "_includes", "**/.ipynb_checkpoints"]
nitpicky = True
# Types of other packages have no page here.
nitpick_ignore_regex = [("py:.*", ".*")]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
highlight_language = "none"
default_role = "code"

# Notebooks are executed at every build, since their numbers are those of the bodycheck that the documentation is about.
nb_execution_mode = "force"
nb_execution_timeout = 600  # s, of a cell; all notebooks together take a minute where nothing else runs
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
napoleon_google_docstring = False
napoleon_use_rtype = False

html_theme = "pydata_sphinx_theme"
html_title = "bodycheck"
html_math_renderer = "mathml"
html_static_path = ["_static"]
templates_path = ["_templates"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_extra_path = ["llms.txt"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
# The front page is a table of contents itself.
html_sidebars = {"**": ["contents.html"], "index": []}
html_context = {"default_mode": "auto"}
html_theme_options = {
    "navbar_center": [],
    "navbar_end": ["versions.html", "theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "show_toc_level": 2,
    "search_bar_text": "Search",
}
